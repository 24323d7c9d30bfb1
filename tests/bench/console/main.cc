// conav-bench-console: how old the robots are that the console's page shows, and what serving it costs.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "bench/console/bare_client.h"
#include "bench/console/browsers.h"
#include "bench/console/console_service.h"
#include "bench/console/load.h"
#include "bench/support/bench_program.h"
#include "bench/support/measure.h"
#include "common/runtime/clock.h"
#include "support/temporary_folder.h"
#include "support/test_domain.h"

namespace conav::bench {
namespace {

/// Ages in ms.
struct Quantiles {
  double p50 = 0.0;
  double p95 = 0.0;
  double p99 = 0.0;
  double max = 0.0;
};

/// What was seen in one while. "Cores": s of processor time per s.
struct Round {
  Quantiles shown;                 // all pages together
  double worst_page_p95_ms = 0.0;  // of the page that has it worst
  Quantiles drawn;
  Quantiles any;
  Quantiles bare;  // of the bare client
  double frames_per_s = 0.0;
  double states_per_s = 0.0;  // of one robot, that a page showed
  double service_cores = 0.0;
  double service_mb = 0.0;        // at its end
  double service_grown_mb = 0.0;  // from its beginning to its end
  double browser_cores = 0.0;     // all browsers
  double load_cores = 0.0;
  double bare_cores = 0.0;
  double connection_kb_per_s = 0.0;  // to one page or the bare client by WebSocket, on average
  double lateness_ms = 0.0;          // of the load, at most
};

/// Everything that takes part.
struct Stage {
  Load& load;
  ConsoleService& service;
  BareClient& bare;
  Browsers& browsers;
};

/// Counters at one time.
struct Counts {
  explicit Counts(const Stage& stage)
      : at(std::chrono::steady_clock::now()),
        service(stage.service.Used()),
        sent_bytes(stage.service.Metric("conav_console_sent_bytes_total")),
        load_cpu_s(stage.load.cpu_s()),
        bare_cpu_s(stage.bare.cpu_s()) {}

  std::chrono::steady_clock::time_point at;
  Usage service;
  double sent_bytes;
  double load_cpu_s;
  double bare_cpu_s;
};

void Append(std::vector<double>& all, const std::vector<double>& values) {
  all.insert(all.end(), values.begin(), values.end());
}

/// All 0 of no values.
Quantiles QuantilesOf(std::vector<double> values) {
  if (values.empty()) return {};
  std::sort(values.begin(), values.end());
  const auto at = [&](double share) {
    const double index = std::ceil(share * static_cast<double>(values.size())) - 1.0;
    return values[static_cast<std::size_t>(std::max(0.0, index))];
  };
  return {at(0.5), at(0.95), at(0.99), values.back()};
}

void AddPages(const std::vector<PageAges>& pages, Round& round) {
  std::vector<double> shown;
  std::vector<double> drawn;
  std::vector<double> any;
  for (const PageAges& page : pages) {
    Append(shown, page.shown);
    Append(drawn, page.drawn);
    Append(any, page.any);
    round.worst_page_p95_ms = std::max(round.worst_page_p95_ms, QuantilesOf(page.shown).p95);
    round.frames_per_s += page.frames_per_s / static_cast<double>(pages.size());
    round.states_per_s += page.states_per_s / static_cast<double>(pages.size());
  }
  round.shown = QuantilesOf(std::move(shown));
  round.drawn = QuantilesOf(std::move(drawn));
  round.any = QuantilesOf(std::move(any));
}

void AddCounts(const Counts& before, const Counts& after, int connections, Round& round) {
  const double seconds = std::chrono::duration<double>(after.at - before.at).count();
  round.service_cores = (after.service.cpu_s - before.service.cpu_s) / seconds;
  round.service_mb = after.service.memory_mb;
  round.service_grown_mb = after.service.memory_mb - before.service.memory_mb;
  round.load_cores = (after.load_cpu_s - before.load_cpu_s) / seconds;
  round.bare_cores = (after.bare_cpu_s - before.bare_cpu_s) / seconds;
  round.connection_kb_per_s =
      (after.sent_bytes - before.sent_bytes) / 1000.0 / seconds / connections;
}

/// Lets `seconds` pass and tells what happened in them. `connections`: pages and bare client that
/// take what they are sent.
Round MeasureRound(Stage& stage, double seconds, int connections) {
  Round round;
  stage.browsers.Begin();
  stage.bare.TakeAges();
  stage.load.TakeLatenessMs();
  const Counts before(stage);
  std::this_thread::sleep_for(std::chrono::duration<double>(seconds));
  const Counts after(stage);
  round.lateness_ms = stage.load.TakeLatenessMs();
  round.bare = QuantilesOf(stage.bare.TakeAges());
  const Browsers::Measured measured = stage.browsers.End();
  AddCounts(before, after, connections, round);
  AddPages(measured.pages, round);
  round.browser_cores =
      measured.cpu_s / std::chrono::duration<double>(after.at - before.at).count();
  return round;
}

inline constexpr double kAgeBarMs = 100.0;  // p95 of the age in the page
inline constexpr double kStallBarMb = 8.0;

struct Series {
  int pages = 0;
  std::vector<Round> rounds;
};

/// One browser stands still: the others, and the service, in as long a while before and meanwhile.
struct Stall {
  int pages = 0;
  Round before;
  Round meanwhile;
};

struct Report {
  LoadOptions load;
  std::size_t picture_bytes = 0;
  double seconds = 0.0;  // of one round
  std::vector<Series> series;
  std::optional<Stall> stall;
};

template <class Of>
std::vector<double> Values(const std::vector<Round>& rounds, Of of) {
  std::vector<double> values;
  for (const Round& round : rounds) values.push_back(of(round));
  return values;
}

template <class Of>
double MedianOf(const std::vector<Round>& rounds, Of of) {
  return Median(Values(rounds, of));
}

/// Medians of the rounds; the maximum is of all.
Quantiles MedianOf(const std::vector<Round>& rounds, Quantiles Round::*quantiles) {
  const auto of = [&](double Quantiles::*value) {
    return Values(rounds, [&](const Round& round) { return round.*quantiles.*value; });
  };
  const std::vector<double> most = of(&Quantiles::max);
  return {Median(of(&Quantiles::p50)), Median(of(&Quantiles::p95)), Median(of(&Quantiles::p99)),
          most.empty() ? 0.0 : *std::max_element(most.begin(), most.end())};
}

double PictureRate(const LoadOptions& load) { return load.state_hz / StatesPerPicture(load); }

/// What the page adds: its age over that of a client without a browser.
double RatioToBare(const std::vector<Round>& rounds) {
  return MedianRatio(Values(rounds, [](const Round& round) { return round.shown.p50; }),
                     Values(rounds, [](const Round& round) { return round.bare.p50; }));
}

double WorstPage(const Series& series) {
  return MedianOf(series.rounds, [](const Round& round) { return round.worst_page_p95_ms; });
}

double GrownByStall(const Stall& stall) {
  return stall.meanwhile.service_grown_mb - stall.before.service_grown_mb;
}

void PrintAges(const char* what, const Quantiles& ages) {
  fmt::print("  {:<34} {:7.1f} {:7.1f} {:7.1f} {:7.1f}\n", what, ages.p50, ages.p95, ages.p99,
             ages.max);
}

void PrintSetting(const Report& report) {
  const Drive& drive = report.load.drive;
  fmt::print("{}, everything on it, medians of {} rounds of {:.0f} s\n", Machine(),
             report.series.empty() ? 0 : report.series[0].rounds.size(), report.seconds);
  fmt::print(
      "{} robots in a world of {} x {} cells: state at {:.0f} Hz each, map when a cell is "
      "entered,\n"
      "snapshot and frame of the live view at {:.1f} Hz each, JPEG of {:.1f} kB\n",
      drive.robots, drive.side, drive.side, report.load.state_hz, PictureRate(report.load),
      static_cast<double>(report.picture_bytes) / 1000.0);
  fmt::print(
      "age: from publishing a state on DDS until the animation frame after the one that drew it\n");
}

void PrintSeries(const Series& series) {
  const std::vector<Round>& rounds = series.rounds;
  fmt::print("\n{} browser{}                              p50     p95     p99     max ms\n",
             series.pages, series.pages == 1 ? " " : "s");
  PrintAges("age of a state when it is shown", MedianOf(rounds, &Round::shown));
  PrintAges("  when the map draws it", MedianOf(rounds, &Round::drawn));
  PrintAges("  when a bare client has it", MedianOf(rounds, &Round::bare));
  PrintAges("age on screen, at any moment", MedianOf(rounds, &Round::any));
  const auto median = [&](double Round::*value) {
    return MedianOf(rounds, [&](const Round& round) { return round.*value; });
  };
  fmt::print("  page over bare client: {:.2f} (p50); worst page's p95: {:.1f} ms\n",
             RatioToBare(rounds), WorstPage(series));
  fmt::print("  a page draws its map {:.1f} times/s and shows {:.1f} states/s of a robot\n",
             median(&Round::frames_per_s), median(&Round::states_per_s));
  fmt::print("  service: {:.1f} % of a core, {:.1f} MB; {:.0f} kB/s to each page\n",
             100.0 * median(&Round::service_cores), median(&Round::service_mb),
             median(&Round::connection_kb_per_s));
  fmt::print(
      "  beside it on the same cores: browsers {:.0f} %, load {:.1f} %, bare client {:.1f} %\n",
      100.0 * median(&Round::browser_cores), 100.0 * median(&Round::load_cores),
      100.0 * median(&Round::bare_cores));
}

void PrintStall(const Stall& stall) {
  fmt::print("\none of {} browsers stands still (SIGSTOP); before and meanwhile\n", stall.pages);
  fmt::print("  p95 of the others: {:.1f} -> {:.1f} ms; of the bare client: {:.1f} -> {:.1f} ms\n",
             stall.before.shown.p95, stall.meanwhile.shown.p95, stall.before.bare.p95,
             stall.meanwhile.bare.p95);
  fmt::print("  the service grows by: {:.2f} -> {:.2f} MB\n", stall.before.service_grown_mb,
             stall.meanwhile.service_grown_mb);
}

void PrintBar(const std::string& what, double value, double bar, const char* unit) {
  fmt::print("{}: {:.1f} {}, under {:.0f}: {}\n", what, value, unit, bar,
             value < bar ? "met" : "MISSED");
}

/// One object: `metrics` and, under `details`, every round.
nlohmann::ordered_json ToJson(const Quantiles& ages) {
  return {{"p50", ages.p50}, {"p95", ages.p95}, {"p99", ages.p99}, {"max", ages.max}};
}

nlohmann::ordered_json ToJson(const Round& round) {
  return {
      {"shown_ms", ToJson(round.shown)},      {"worst_page_p95_ms", round.worst_page_p95_ms},
      {"drawn_ms", ToJson(round.drawn)},      {"any_moment_ms", ToJson(round.any)},
      {"bare_ms", ToJson(round.bare)},        {"frames_per_s", round.frames_per_s},
      {"states_per_s", round.states_per_s},   {"service_cores", round.service_cores},
      {"service_mb", round.service_mb},       {"service_grown_mb", round.service_grown_mb},
      {"browser_cores", round.browser_cores}, {"load_cores", round.load_cores},
      {"bare_cores", round.bare_cores},       {"connection_kb_per_s", round.connection_kb_per_s},
      {"load_lateness_ms", round.lateness_ms}};
}

nlohmann::ordered_json ToJson(const Series& series) {
  nlohmann::ordered_json json{{"pages", series.pages}};
  for (const Round& round : series.rounds) json["rounds"].push_back(ToJson(round));
  return json;
}

nlohmann::ordered_json ToJson(const Stall& stall) {
  return {{"pages", stall.pages},
          {"before", ToJson(stall.before)},
          {"meanwhile", ToJson(stall.meanwhile)}};
}

void AddMetrics(const Stall& stall, nlohmann::ordered_json& metrics) {
  metrics["stall_grown_mb"] = GrownByStall(stall);
  metrics["stall_others_ratio"] = stall.meanwhile.shown.p95 / stall.before.shown.p95;
}

void AddMetrics(const Series& series, nlohmann::ordered_json& metrics) {
  const auto add = [&](const char* name, double value) {
    metrics[fmt::format("pages{}_{}", series.pages, name)] = value;
  };
  const auto median = [&](double Round::*value) {
    return MedianOf(series.rounds, [&](const Round& round) { return round.*value; });
  };
  add("p50_ms", MedianOf(series.rounds, &Round::shown).p50);
  add("p95_ms", MedianOf(series.rounds, &Round::shown).p95);
  add("worst_page_p95_ms", WorstPage(series));
  add("bare_p95_ms", MedianOf(series.rounds, &Round::bare).p95);
  add("bare_ratio", RatioToBare(series.rounds));
  add("service_cores", median(&Round::service_cores));
  add("service_mb", median(&Round::service_mb));
}

/// What was played, what an age is, a line for each number of pages, and the bars.
void PrintTable(const Report& report) {
  PrintSetting(report);
  for (const Series& series : report.series) PrintSeries(series);
  if (report.stall) PrintStall(*report.stall);
  fmt::print("\n");
  for (const Series& series : report.series) {
    PrintBar(fmt::format("p95 in the worst of {} page(s)", series.pages), WorstPage(series),
             kAgeBarMs, "ms");
  }
  if (report.stall) {
    PrintBar("cost of a stalled browser to the service", GrownByStall(*report.stall), kStallBarMb,
             "MB");
  }
}

nlohmann::ordered_json ToJson(const Report& report) {
  nlohmann::ordered_json json;
  json["benchmark"] = "console";
  json["machine"] = Machine();
  json["robots"] = report.load.drive.robots;
  json["side"] = report.load.drive.side;
  json["state_hz"] = report.load.state_hz;
  json["picture_hz"] = PictureRate(report.load);
  json["seconds"] = report.seconds;
  for (const Series& series : report.series) {
    AddMetrics(series, json["metrics"]);
    json["details"].push_back(ToJson(series));
  }
  if (report.stall) {
    AddMetrics(*report.stall, json["metrics"]);
    json["stall"] = ToJson(*report.stall);
  }
  return json;
}

struct Options {
  LoadOptions load;
  int rounds = 5;
  double seconds = 10.0;
  std::vector<int> pages{1, 8};
  double stall_s = 15.0;
  std::string json_file;
};

bus::ParticipantOptions BusOn(int domain) {
  bus::ParticipantOptions bus;
  bus.domain_id = domain;
  bus.interface = "lo";
  return bus;
}

Stall MeasureStall(Stage& stage, int pages, double seconds) {
  Stall stall{pages, MeasureRound(stage, seconds, pages + 1), {}};
  stage.browsers.Stop();
  stall.meanwhile = MeasureRound(stage, seconds, pages);
  stage.browsers.Continue();
  return stall;
}

Series MeasureSeries(Stage& stage, const Options& options, int pages) {
  Series series{pages, {}};
  for (int round = 0; round < options.rounds; ++round) {
    ShowRound(round, options.rounds);
    series.rounds.push_back(MeasureRound(stage, options.seconds, pages + 1));
  }
  return series;
}

Report Measure(Options options) {
  const test::TemporaryFolder folder;
  const auto domain = test::LeaseDomain();
  std::sort(options.pages.begin(), options.pages.end());
  options.load.drive.begin_s = WallSeconds();
  ConsoleService service(folder.path(), options.load.drive, domain.domain());
  bus::Participant participant("bench_console", BusOn(domain.domain()));
  Load load(participant, options.load);
  BareClient bare(service.port(), options.load.drive, RobotName(0));
  Browsers browsers(folder.path());
  Stage stage{load, service, bare, browsers};
  Report report{options.load, load.picture_bytes(), options.seconds, {}, {}};
  for (const int pages : options.pages) {
    browsers.Open(service.url(), pages, options.load.drive);
    report.series.push_back(MeasureSeries(stage, options, pages));
  }
  const int most = options.pages.back();
  if (options.stall_s > 0.0 && most > 1) report.stall = MeasureStall(stage, most, options.stall_s);
  if (bare.ended()) throw StartupError("the service has closed the bare client");
  return report;
}

void AddOptions(CLI::App& app, Options& options) {
  Drive& drive = options.load.drive;
  AddUsualOptions(app, options.json_file, options.rounds);
  AddNumber(app, "--seconds", options.seconds, "Length of a round", {0.5, 600.0});
  app.add_option("--pages", options.pages, "Numbers of browsers, such as 1,8")
      ->delimiter(',')
      ->capture_default_str()
      ->check(CLI::Range(1, 30));
  AddNumber(app, "--robots", drive.robots, "Robots", {1, 26});
  AddNumber(app, "--side", drive.side, "Cells on each side of their world", {28, 500});
  AddNumber(app, "--state-hz", options.load.state_hz, "States of each robot", {1.0, 1000.0});
  AddNumber(app, "--picture-hz", options.load.picture_hz,
            "Pictures of each robot; each comes with a state", {0.1, 100.0});
  // Under 20 s: then the service gives such a page up.
  AddNumber(app, "--stall", options.stall_s,
            "s for which the last of several browsers is stopped; 0 = not at all", {0.0, 18.0});
}

}  // namespace
}  // namespace conav::bench

using namespace conav::bench;

int main(int argc, char** argv) {
  CLI::App app(
      "How old the robots are that the console shows: the operator service with its page in real "
      "headless browsers, fed over DDS as simulators do it, and beside them a bare WebSocket "
      "client; what that costs the service; and what a browser that stands still costs it and the "
      "others.",
      "conav bench console");
  Options options;
  AddOptions(app, options);
  return RunBenchmark(app, argc, argv, [&] {
    const Report report = Measure(options);
    PrintTable(report);
    WriteFigures(options.json_file, ToJson(report));
  });
}
