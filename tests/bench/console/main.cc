// conav-bench-console: how old the robots are that the console's page shows, and what serving it costs.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <nlohmann/json.hpp>

#include "bench/console/report.h"
#include "bench/support/bench_program.h"
#include "common/runtime/clock.h"
#include "support/temporary_folder.h"
#include "support/test_domain.h"

namespace {

namespace bench = conav::bench;

struct Options {
  bench::LoadOptions load;
  int rounds = 5;
  double seconds = 10.0;
  std::vector<int> pages{1, 8};
  double stall_s = 15.0;
  std::string json_file;
};

conav::bus::ParticipantOptions BusOn(int domain) {
  conav::bus::ParticipantOptions bus;
  bus.domain_id = domain;
  bus.interface = "lo";
  return bus;
}

bench::Stall MeasureStall(bench::Stage& stage, int pages, double seconds) {
  bench::Stall stall{pages, bench::MeasureRound(stage, seconds, pages + 1), {}};
  stage.browsers.Stop();
  stall.meanwhile = bench::MeasureRound(stage, seconds, pages);
  stage.browsers.Continue();
  return stall;
}

bench::Series MeasureSeries(bench::Stage& stage, const Options& options, int pages) {
  bench::Series series{pages, {}};
  for (int round = 0; round < options.rounds; ++round) {
    bench::ShowRound(round, options.rounds);
    series.rounds.push_back(bench::MeasureRound(stage, options.seconds, pages + 1));
  }
  return series;
}

bench::Report Measure(Options options) {
  const conav::test::TemporaryFolder folder;
  const auto domain = conav::test::LeaseDomain();
  std::sort(options.pages.begin(), options.pages.end());
  options.load.drive.begin_s = conav::WallSeconds();
  bench::ConsoleService service(folder.path(), options.load.drive, domain.domain());
  conav::bus::Participant participant("bench_console", BusOn(domain.domain()));
  bench::Load load(participant, options.load);
  bench::BareClient bare(service.port(), options.load.drive, bench::RobotName(0));
  bench::Browsers browsers(folder.path());
  bench::Stage stage{load, service, bare, browsers};
  bench::Report report{options.load, load.picture_bytes(), options.seconds, {}, {}};
  for (const int pages : options.pages) {
    browsers.Open(service.url(), pages, options.load.drive);
    report.series.push_back(MeasureSeries(stage, options, pages));
  }
  const int most = options.pages.back();
  if (options.stall_s > 0.0 && most > 1) report.stall = MeasureStall(stage, most, options.stall_s);
  if (bare.ended()) throw conav::StartupError("the service has closed the bare client");
  return report;
}

void AddOptions(CLI::App& app, Options& options) {
  bench::Drive& drive = options.load.drive;
  bench::AddUsualOptions(app, options.json_file, options.rounds);
  app.add_option("--seconds", options.seconds, "Length of a round")
      ->capture_default_str()
      ->check(CLI::Range(0.5, 600.0));
  app.add_option("--pages", options.pages, "Numbers of browsers, such as 1,8")
      ->delimiter(',')
      ->capture_default_str()
      ->check(CLI::Range(1, 30));
  app.add_option("--robots", drive.robots, "Robots")
      ->capture_default_str()
      ->check(CLI::Range(1, 26));
  app.add_option("--side", drive.side, "Cells on each side of their world")
      ->capture_default_str()
      ->check(CLI::Range(28, 500));
  app.add_option("--state-hz", options.load.state_hz, "States of each robot")
      ->capture_default_str()
      ->check(CLI::Range(1.0, 1000.0));
  app.add_option("--picture-hz", options.load.picture_hz,
                 "Pictures of each robot; each comes with a state")
      ->capture_default_str()
      ->check(CLI::Range(0.1, 100.0));
  // Under 20 s: then the service gives such a page up.
  app.add_option("--stall", options.stall_s,
                 "s for which the last of several browsers is stopped; 0 = not at all")
      ->capture_default_str()
      ->check(CLI::Range(0.0, 18.0));
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(
      "How old the robots are that the console shows: the operator service with its page in real "
      "headless browsers, fed over DDS as simulators do it, and beside them a bare WebSocket "
      "client; what that costs the service; and what a browser that stands still costs it and the "
      "others.",
      "conav bench console");
  Options options;
  AddOptions(app, options);
  return bench::RunBenchmark(app, argc, argv, [&] {
    const bench::Report report = Measure(options);
    bench::PrintTable(report);
    bench::WriteFigures(options.json_file, bench::ToJson(report));
  });
}
