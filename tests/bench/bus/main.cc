// conav-bench-bus: what our bus costs over raw use of the same vendor.
#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "bench/bus/traffic.h"
#include "bench/support/bench_program.h"
#include "bench/support/measure.h"
#include "common/bus/backend.h"
#include "common/bus/cyclone/backend.h"
#include "support/test_domain.h"

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

/// Round trip of Cyclone's own ddsperf with the bus's configuration; its ping prints half of it,
/// which is doubled here. Nothing when ddsperf is not installed.
std::optional<RoundTrips> MeasureDdsperf(std::size_t size, int domain_id) {
  if (std::system("command -v ddsperf > /dev/null 2>&1") != 0) return std::nullopt;
  const bus::ParticipantOptions options =
      BusOptions({std::string(Name(bus::kDefaultVendor)), true, domain_id});
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

/// What one vendor did at one payload size, a value for each round.
struct Series {
  std::string vendor;
  std::size_t size = 0;
  std::vector<RoundTrips> bus;
  std::vector<RoundTrips> raw;
  std::vector<double> bus_rate;  // messages per second
  std::vector<double> raw_rate;
};

struct RoundsOptions {
  int rounds = 0;
  std::uint64_t trips = 0;  // per round, stack and size
  std::string own_program;
  int bus_domain = 0;
  int raw_domain = 0;
};

inline constexpr std::size_t kSmall = 64;
inline constexpr std::size_t kLarge = 20'000;

/// As many messages as take a comparable time at each size.
std::uint64_t FloodLength(std::size_t size, std::uint64_t trips) {
  return size > 1000 ? trips : trips * 10;
}

void MeasureRound(Traffic& bus, Traffic& raw, int round, std::uint64_t trips, Series& series) {
  const auto measure_bus = [&] { series.bus.push_back(bus.MeasureRoundTrips(series.size, trips)); };
  const auto measure_raw = [&] { series.raw.push_back(raw.MeasureRoundTrips(series.size, trips)); };
  if (round % 2 == 0) {
    measure_bus();
    measure_raw();
  } else {
    measure_raw();
    measure_bus();
  }
  const std::uint64_t flood = FloodLength(series.size, trips);
  series.bus_rate.push_back(bus.MeasureRate(series.size, flood));
  series.raw_rate.push_back(raw.MeasureRate(series.size, flood));
}

/// Measures bus and raw in turn, round by round, so that both see the same machine. One Series per
/// vendor and size. Throws std::runtime_error.
std::vector<Series> RunRounds(const RoundsOptions& options) {
  std::vector<Series> result;
  for (const std::string& vendor : Names(bus::kVendors)) {
    Traffic bus({vendor, false, options.bus_domain}, options.own_program);
    Traffic raw({vendor, true, options.raw_domain}, options.own_program);
    Series small{vendor, kSmall, {}, {}, {}, {}};
    Series large{vendor, kLarge, {}, {}, {}, {}};
    for (int round = 0; round < options.rounds; ++round) {
      MeasureRound(bus, raw, round, options.trips, small);
      MeasureRound(bus, raw, round, options.trips, large);
    }
    result.push_back(std::move(small));
    result.push_back(std::move(large));
  }
  return result;
}

/// One figure of each round.
std::vector<double> Values(const std::vector<RoundTrips>& rounds, double RoundTrips::*value) {
  std::vector<double> values;
  for (const RoundTrips& round : rounds) values.push_back(round.*value);
  return values;
}

/// The median over the rounds of bus p50 / raw p50.
double Ratio(const Series& series) {
  return MedianRatio(Values(series.bus, &RoundTrips::p50_us),
                     Values(series.raw, &RoundTrips::p50_us));
}

struct Report {
  std::vector<Series> series;
  std::optional<RoundTrips> ddsperf_small;
  std::optional<RoundTrips> ddsperf_large;
};

const char* SizeName(std::size_t size) { return size == kSmall ? "64B" : "20kB"; }

double MedianOf(const std::vector<RoundTrips>& rounds, double RoundTrips::*value) {
  return Median(Values(rounds, value));
}

nlohmann::ordered_json Details(const Series& series) {
  return {{"vendor", series.vendor},
          {"bytes", series.size},
          {"bus_p50_us", Values(series.bus, &RoundTrips::p50_us)},
          {"raw_p50_us", Values(series.raw, &RoundTrips::p50_us)},
          {"bus_p99_us", Values(series.bus, &RoundTrips::p99_us)},
          {"raw_p99_us", Values(series.raw, &RoundTrips::p99_us)},
          {"bus_messages_per_s", series.bus_rate},
          {"raw_messages_per_s", series.raw_rate}};
}

void PrintDdsperf(const char* size, const std::optional<RoundTrips>& measured) {
  if (!measured) return;
  fmt::print("ddsperf     {:>5}  {:>17}  {:8.1f} {:8.1f}\n", size, "", measured->p50_us,
             measured->p99_us);
}

void PrintTable(const Report& report) {
  fmt::print("{}, loopback, medians of {} rounds\n", Machine(),
             report.series.empty() ? 0 : report.series[0].bus.size());
  fmt::print("                   bus p50/p99 us     raw p50/p99 us     ratio  bus/raw msg/s\n");
  for (const Series& series : report.series) {
    fmt::print("{:<11} {:>5}  {:8.1f} {:8.1f}  {:8.1f} {:8.1f}  {:8.3f}  {:.0f} / {:.0f}\n",
               series.vendor, SizeName(series.size), MedianOf(series.bus, &RoundTrips::p50_us),
               MedianOf(series.bus, &RoundTrips::p99_us), MedianOf(series.raw, &RoundTrips::p50_us),
               MedianOf(series.raw, &RoundTrips::p99_us), Ratio(series), Median(series.bus_rate),
               Median(series.raw_rate));
  }
  PrintDdsperf("64B", report.ddsperf_small);
  PrintDdsperf("20kB", report.ddsperf_large);
}

/// One object: `metrics` {cyclonedds_64B_ratio, cyclonedds_20kB_ratio, fastdds_64B_ratio,
/// fastdds_20kB_ratio}, each the median over the rounds of our round trip over the raw one, and
/// `details` with every round.
nlohmann::ordered_json ToJson(const Report& report) {
  nlohmann::ordered_json json;
  json["benchmark"] = "bus";
  json["machine"] = Machine();
  for (const Series& series : report.series) {
    json["metrics"][fmt::format("{}_{}_ratio", series.vendor, SizeName(series.size))] =
        Ratio(series);
    json["details"].push_back(Details(series));
  }
  const auto add_ddsperf = [&](const char* size, const std::optional<RoundTrips>& measured) {
    if (!measured) return;
    json["ddsperf"][size] = {{"p50_us", measured->p50_us}, {"p99_us", measured->p99_us}};
  };
  add_ddsperf("64B", report.ddsperf_small);
  add_ddsperf("20kB", report.ddsperf_large);
  return json;
}

/// The other process: echoes until its standard input ends.
void RunPeer(const StackOptions& options) {
  const auto echo = MakeEcho(options);
  char byte = 0;
  while (read(STDIN_FILENO, &byte, 1) > 0) {
  }
}

void Compare(RoundsOptions options, bool with_ddsperf, const std::string& json_file) {
  const auto bus = test::LeaseDomain();
  const auto raw = test::LeaseDomain();
  options.bus_domain = bus.domain();
  options.raw_domain = raw.domain();
  Report report;
  report.series = RunRounds(options);
  if (with_ddsperf) {
    report.ddsperf_small = MeasureDdsperf(kSmall, options.bus_domain);
    report.ddsperf_large = MeasureDdsperf(kLarge, options.bus_domain);
  }
  PrintTable(report);
  WriteFigures(json_file, ToJson(report));
}

}  // namespace
}  // namespace conav::bench

using namespace conav::bench;

int main(int argc, char** argv) {
  CLI::App app(
      "Round trip and throughput of the bus over raw use of the same vendor: two processes on the "
      "loopback interface, bus and raw in turn, same payload, QoS and sockets.",
      "conav bench bus");
  RoundsOptions options{31, 1000, "/proc/self/exe"};
  std::string json_file;
  bool no_ddsperf = false;
  StackOptions peer;
  AddUsualOptions(app, json_file, options.rounds);
  AddNumber(app, "--trips", options.trips, "Round trips per repetition, stack and size",
            {10, 1000000});
  app.add_flag("--no-ddsperf", no_ddsperf, "Do not run ddsperf beside it");
  app.add_option("--peer", peer.vendor, "Be the other process (used by the benchmark itself)");
  app.add_option("--domain", peer.domain_id, "Domain of --peer");
  app.add_flag("--raw", peer.raw, "Stack of --peer");
  return RunBenchmark(app, argc, argv, [&] {
    if (peer.vendor.empty()) {
      Compare(options, !no_ddsperf, json_file);
    } else {
      RunPeer(peer);
    }
  });
}
