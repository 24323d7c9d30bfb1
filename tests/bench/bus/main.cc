// conav-bench-bus: what our bus costs over raw use of the same vendor.
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "bench/bus/ddsperf.h"
#include "bench/bus/report.h"
#include "bench/support/bench_program.h"
#include "support/test_domain.h"

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

void Compare(conav::bench::RoundsOptions options, bool with_ddsperf, const std::string& json_file) {
  const auto bus = conav::test::LeaseDomain();
  const auto raw = conav::test::LeaseDomain();
  options.bus_domain = bus.domain();
  options.raw_domain = raw.domain();
  Report report;
  report.series = conav::bench::RunRounds(options);
  if (with_ddsperf) {
    report.ddsperf_small = conav::bench::MeasureDdsperf(conav::bench::kSmall, options.bus_domain);
    report.ddsperf_large = conav::bench::MeasureDdsperf(conav::bench::kLarge, options.bus_domain);
  }
  conav::bench::PrintTable(report);
  conav::bench::WriteFigures(json_file, conav::bench::ToJson(report));
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(
      "Round trip and throughput of the bus over raw use of the same vendor: two processes on the "
      "loopback interface, bus and raw in turn, same payload, QoS and sockets.",
      "conav bench bus");
  conav::bench::RoundsOptions options{31, 1000, "/proc/self/exe"};
  std::string json_file;
  bool no_ddsperf = false;
  StackOptions peer;
  conav::bench::AddUsualOptions(app, json_file, options.rounds);
  app.add_option("--trips", options.trips, "Round trips per repetition, stack and size")
      ->capture_default_str()
      ->check(CLI::Range(10, 1000000));
  app.add_flag("--no-ddsperf", no_ddsperf, "Do not run ddsperf beside it");
  app.add_option("--peer", peer.vendor, "Be the other process (used by the benchmark itself)");
  app.add_option("--domain", peer.domain_id, "Domain of --peer");
  app.add_flag("--raw", peer.raw, "Stack of --peer");
  return conav::bench::RunBenchmark(app, argc, argv, [&] {
    if (peer.vendor.empty()) {
      Compare(options, !no_ddsperf, json_file);
    } else {
      RunPeer(peer);
    }
  });
}
