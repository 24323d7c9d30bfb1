#include "bench/support/measure.h"

#include <fmt/format.h>

#include <algorithm>
#include <ctime>
#include <fstream>
#include <thread>

#include "common/runtime/result.h"

namespace conav::bench {

std::string Machine() {
  std::string model = "unknown processor";
  std::ifstream file("/proc/cpuinfo");
  for (std::string line; std::getline(file, line);) {
    const auto colon = line.find(": ");
    if (line.starts_with("model name") && colon != std::string::npos)
      model = line.substr(colon + 2);
  }
  return fmt::format("{} x {}", std::thread::hardware_concurrency(), model);
}

double Median(std::vector<double> values) {
  if (values.empty()) return 0.0;
  std::sort(values.begin(), values.end());
  const std::size_t middle = values.size() / 2;
  return values.size() % 2 == 1 ? values[middle] : (values[middle - 1] + values[middle]) / 2.0;
}

double MedianRatio(const std::vector<double>& above, const std::vector<double>& below) {
  DEMAND(above.size() == below.size(), above.size(), below.size());
  std::vector<double> ratios;
  for (std::size_t i = 0; i < above.size(); ++i) ratios.push_back(above[i] / below[i]);
  return Median(std::move(ratios));
}

double FlopsOfPass(const nhpm::NetworkShape& shape, int cells) {
  double weights = 0.0;
  for (int layer = 0; layer < nhpm::kNetworkLayers; ++layer) {
    weights += static_cast<double>(shape.WeightsOf(layer));
  }
  return 2.0 * cells * weights;
}

double ThreadSeconds() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

}  // namespace conav::bench
