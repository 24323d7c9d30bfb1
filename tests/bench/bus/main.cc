// conav-bench-bus: what our bus costs over raw use of the same vendor.
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <iostream>
#include <nlohmann/json.hpp>

#include "bench/bus/ddsperf.h"
#include "bench/bus/report.h"
#include "common/runtime/json.h"
#include "common/runtime/log.h"

namespace {

using conav::bench::Report;
using conav::bench::StackOptions;

/// The other process: echoes until its standard input ends.
void RunPeer(const StackOptions& options) {
  const auto echo = conav::bench::MakeEcho(options);
  char byte = 0;
  while (read(STDIN_FILENO, &byte, 1) > 0) {
  }
}

int RunBenchmark(const conav::bench::RoundsOptions& options, bool with_ddsperf,
                 const std::string& json_file) {
  Report report;
  report.series = conav::bench::RunRounds(options);
  if (with_ddsperf) {
    report.ddsperf_small = conav::bench::MeasureDdsperf(conav::bench::kSmall, options.first_domain);
    report.ddsperf_large = conav::bench::MeasureDdsperf(conav::bench::kLarge, options.first_domain);
  }
  conav::bench::PrintTable(report);
  if (json_file.empty()) return 0;
  const auto written = conav::WriteJsonFile(json_file, conav::bench::ToJson(report));
  if (!written) std::cerr << written.error().text << "\n";
  return written ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(
      "Round trip and throughput of the bus over raw use of the same vendor: two processes on the "
      "loopback interface, bus and raw in turn, same payload, QoS and sockets.");
  conav::bench::RoundsOptions options{31, 1000, "/proc/self/exe", 20 + 2 * (getpid() % 100)};
  std::string json_file;
  bool no_ddsperf = false;
  StackOptions peer;
  app.add_option("--json", json_file, "Write figures to this file");
  app.add_option("--rounds", options.rounds, "Repetitions; medians are over these")
      ->capture_default_str()
      ->check(CLI::Range(1, 1000));
  app.add_option("--trips", options.trips, "Round trips per repetition, stack and size")
      ->capture_default_str()
      ->check(CLI::Range(10, 1000000));
  app.add_flag("--no-ddsperf", no_ddsperf, "Do not run ddsperf beside it");
  app.add_option("--peer", peer.vendor, "Be the other process (used by the benchmark itself)");
  app.add_option("--domain", peer.domain_id, "Domain of --peer");
  app.add_flag("--raw", peer.raw, "Stack of --peer");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  conav::log::SetMinimumLevel(conav::log::Level::kWarning);
  try {
    if (peer.vendor.empty()) return RunBenchmark(options, !no_ddsperf, json_file);
    RunPeer(peer);
    return 0;
  } catch (const std::exception& error) {
    std::cerr << "conav-bench-bus: " << error.what() << "\n";
    return 1;
  }
}
