#include "bench/support/bench_program.h"

#include <fmt/core.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <ctime>
#include <fstream>
#include <thread>

#include "common/cli/cli.h"
#include "common/runtime/log.h"
#include "common/runtime/text.h"

namespace conav::bench {

BenchProgram::BenchProgram(const std::string& name, const std::string& about, int rounds)
    : app_(about, name), rounds_(rounds) {
  app_.add_option("--json", json_file_, "Write figures to this file")->check(WritableFile());
  AddNumber("--rounds", rounds_, "Repetitions; medians are over these", 1, 1000);
}

void BenchProgram::ForEachRound(const std::function<void()>& round) const {
  for (int i = 1; i <= rounds_; ++i) {
    if (isatty(STDERR_FILENO) != 0) {
      fmt::print(stderr, "\rround {} of {} {}", i, rounds_, i == rounds_ ? "\n" : "");
    }
    round();
  }
}

void BenchProgram::Write(const Json& figures) const {
  if (json_file_.empty()) return;
  const std::string name = app_.get_name();
  Json document{{"benchmark", name.substr(name.find_last_of(" -") + 1)}, {"machine", Machine()}};
  document.update(figures);
  const auto written = WriteJsonFile(json_file_, document);
  if (!written) throw StartupError(written.error().text);
}

int BenchProgram::Run(int argc, char** argv, const std::function<void()>& run) {
  if (const auto ended = Parse(app_, argc, argv)) return *ended;
  log::SetMinimumLevel(log::Level::kWarning);
  try {
    run();
    return 0;
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}: {}\n", app_.get_name(), error.what());
    return 1;
  }
}

void AddWidth(BenchProgram& program, int& width) {
  program.app()
      .add_option("--width", width, "Channels of the hidden layers")
      ->capture_default_str()
      ->check(CLI::IsMember({16, 32, 64}));
}

double Median(std::vector<double> values) {
  if (values.empty()) return 0.0;
  std::sort(values.begin(), values.end());
  const std::size_t middle = values.size() / 2;
  return values.size() % 2 == 1 ? values[middle] : (values[middle - 1] + values[middle]) / 2.0;
}

double Quantile(std::vector<double> values, double share) {
  if (values.empty()) return 0.0;
  std::sort(values.begin(), values.end());
  const double index = std::ceil(share * static_cast<double>(values.size())) - 1.0;
  return values[static_cast<std::size_t>(std::max(0.0, index))];
}

void Rounds::Add(std::initializer_list<std::pair<std::string, double>> values) {
  for (const auto& [name, value] : values) values_[name].push_back(value);
}

Json Rounds::Medians() const {
  Json medians;
  for (const auto& [name, values] : values_.items()) medians[name] = Median(name);
  return medians;
}

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

double ThreadSeconds() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

double ThreadSecondsOf(const std::function<void()>& call) {
  const double start = ThreadSeconds();
  call();
  return ThreadSeconds() - start;
}

double WallSecondsOf(const std::function<void()>& call) {
  const auto start = std::chrono::steady_clock::now();
  call();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

double FlopsOfPass(const nhpm::NetworkShape& shape, int cells) {
  double weights = 0.0;
  for (int layer = 0; layer < nhpm::kNetworkLayers; ++layer) {
    weights += static_cast<double>(shape.WeightsOf(layer));
  }
  return 2.0 * cells * weights;
}

}  // namespace conav::bench
