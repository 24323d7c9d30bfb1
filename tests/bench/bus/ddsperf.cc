#include "bench/bus/ddsperf.h"

#include <fmt/format.h>

#include <cstdio>
#include <cstdlib>

#include "common/bus/backend.h"
#include "common/bus/cyclone/domain.h"

namespace conav::bench {
namespace {

/// "... 50% 3.9us 90% ..." holds the value after "50% ".
std::optional<double> ValueAfter(const std::string& line, const char* label) {
  const auto place = line.find(label);
  if (place == std::string::npos) return std::nullopt;
  return std::strtod(line.c_str() + place + std::char_traits<char>::length(label), nullptr);
}

std::string LastMeasurement(const std::string& command) {
  std::string last;
  char line[512];
  FILE* output = popen(command.c_str(), "r");
  if (output == nullptr) return last;
  while (std::fgets(line, sizeof line, output) != nullptr) {
    if (std::string_view(line).find(" 50% ") != std::string_view::npos) last = line;
  }
  pclose(output);
  return last;
}

}  // namespace

std::optional<RoundTrips> MeasureDdsperf(std::size_t size, int domain_id) {
  if (std::system("command -v ddsperf > /dev/null 2>&1") != 0) return std::nullopt;
  const bus::ParticipantOptions options = BusOptions({bus::kCycloneDds, true, domain_id});
  const std::string configuration =
      bus::CycloneConfiguration(bus::ResolveNetwork(options), options.lease_s);
  setenv("CYCLONEDDS_URI", configuration.c_str(), 1);
  PeerProcess pong("ddsperf", {"-i", std::to_string(domain_id), "-D", "5", "pong"}, true);
  const std::string line =
      LastMeasurement(fmt::format("ddsperf -i {} -D 3 ping size {} 2>&1", domain_id, size));
  pong.Terminate();
  unsetenv("CYCLONEDDS_URI");
  const auto p50 = ValueAfter(line, " 50% ");
  const auto p99 = ValueAfter(line, " 99% ");
  if (!p50 || !p99) return std::nullopt;
  return RoundTrips{2.0 * *p50, 2.0 * *p99};
}

}  // namespace conav::bench
