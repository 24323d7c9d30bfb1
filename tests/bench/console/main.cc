// conav-bench-console: how old the robots are that the console's page shows, and what serving it costs.
#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <thread>

#include "bench/console/viewers.h"
#include "bench/support/bench_program.h"
#include "common/runtime/clock.h"
#include "support/loopback.h"
#include "support/temporary_folder.h"

namespace conav::bench {
namespace {

constexpr double kAgeBarMs = 100.0;  // p95 of the age in the page
constexpr double kStallBarMb = 8.0;
constexpr double kPageCoreBar = 0.2;  // of a core for a page, its browser included

struct Options {
  LoadOptions load;
  double seconds = 10.0;  // of a round
  std::vector<int> pages{1, 4, 8};
  double stall_s = 15.0;
  double move_s = 6.0;

  double SnapshotRate() const { return load.state_hz / load.StatesPerSnapshot(); }
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
      : service(stage.service.Used()),
        sent_bytes(stage.service.Metric("conav_console_sent_bytes_total")),
        load_cpu_s(stage.load.cpu_s()),
        bare_cpu_s(stage.bare.cpu_s()) {}

  std::chrono::steady_clock::time_point at = std::chrono::steady_clock::now();
  Usage service;
  double sent_bytes;
  double load_cpu_s;
  double bare_cpu_s;
};

/// Of ages in ms.
Json Quantiles(const std::vector<double>& values) {
  return {{"p50", Quantile(values, 0.5)},
          {"p95", Quantile(values, 0.95)},
          {"p99", Quantile(values, 0.99)},
          {"max", Quantile(values, 1.0)}};
}

/// Of all pages together.
Json Quantiles(const std::vector<PageAges>& pages, std::vector<double> PageAges::*ages) {
  std::vector<double> all;
  for (const PageAges& page : pages) {
    all.insert(all.end(), (page.*ages).begin(), (page.*ages).end());
  }
  return Quantiles(all);
}

double Mean(const std::vector<PageAges>& pages, double PageAges::*value) {
  double mean = 0.0;
  for (const PageAges& page : pages) mean += page.*value / static_cast<double>(pages.size());
  return mean;
}

/// Lets `seconds` pass and says what happened in them; all ages in ms, "cores": s of processor time
/// per s. `connections`: pages and bare client that take what they are sent.
Json MeasureRound(Stage& stage, double seconds, int connections) {
  stage.browsers.Begin();
  stage.bare.TakeAges();
  stage.load.TakeLatenessMs();
  const Counts before(stage);
  std::this_thread::sleep_for(std::chrono::duration<double>(seconds));
  const Counts after(stage);
  const double lateness_ms = stage.load.TakeLatenessMs();
  const Json bare = Quantiles(stage.bare.TakeAges());
  const auto [pages, browsers_cpu_s] = stage.browsers.End();
  double worst_page_p95_ms = 0.0;
  for (const PageAges& page : pages) {
    worst_page_p95_ms = std::max(worst_page_p95_ms, Quantile(page.shown, 0.95));
  }
  const double taken_s = std::chrono::duration<double>(after.at - before.at).count();
  return {{"shown_ms", Quantiles(pages, &PageAges::shown)},
          {"worst_page_p95_ms", worst_page_p95_ms},
          {"drawn_ms", Quantiles(pages, &PageAges::drawn)},
          {"any_moment_ms", Quantiles(pages, &PageAges::any)},
          {"bare_ms", bare},
          {"frames_per_s", Mean(pages, &PageAges::frames_per_s)},
          {"states_per_s", Mean(pages, &PageAges::states_per_s)},
          {"service_cores", (after.service.cpu_s - before.service.cpu_s) / taken_s},
          {"service_mb", after.service.memory_mb},
          {"service_grown_mb", after.service.memory_mb - before.service.memory_mb},
          {"browser_cores", browsers_cpu_s / taken_s},
          {"load_cores", (after.load_cpu_s - before.load_cpu_s) / taken_s},
          {"bare_cores", (after.bare_cpu_s - before.bare_cpu_s) / taken_s},
          {"connection_kb_per_s",
           (after.sent_bytes - before.sent_bytes) / 1000.0 / taken_s / connections},
          {"load_lateness_ms", lateness_ms}};
}

double Figure(const Json& round, const std::string& path) {
  return round.at(Json::json_pointer("/" + path)).get<double>();
}

/// The median of the rounds of one series, {pages, rounds}.
double MedianOf(const Json& series, const std::string& path) {
  std::vector<double> values;
  for (const Json& round : series["rounds"]) values.push_back(Figure(round, path));
  return Median(std::move(values));
}

/// What the page adds: its age over that of a client without a browser.
double RatioToBare(const Json& series) {
  std::vector<double> ratios;
  for (const Json& round : series["rounds"]) {
    ratios.push_back(Figure(round, "shown_ms/p50") / Figure(round, "bare_ms/p50"));
  }
  return Median(std::move(ratios));
}

double GrownByStall(const Json& stall) {
  return Figure(stall, "meanwhile/service_grown_mb") - Figure(stall, "before/service_grown_mb");
}

/// Medians of the rounds; the maximum is of all.
void PrintAges(const char* what, const Json& series, const std::string& ages) {
  double most = 0.0;
  for (const Json& round : series["rounds"]) most = std::max(most, Figure(round, ages + "/max"));
  fmt::print("  {:<34} {:7.1f} {:7.1f} {:7.1f} {:7.1f}\n", what, MedianOf(series, ages + "/p50"),
             MedianOf(series, ages + "/p95"), MedianOf(series, ages + "/p99"), most);
}

void PrintSeries(const Json& series) {
  const int pages = series["pages"];
  const auto median = [&](const char* path) { return MedianOf(series, path); };
  fmt::print("\n{} browser{}                              p50     p95     p99     max ms\n", pages,
             pages == 1 ? " " : "s");
  PrintAges("age of a state when it is shown", series, "shown_ms");
  PrintAges("  when the map draws it", series, "drawn_ms");
  PrintAges("  when a bare client has it", series, "bare_ms");
  PrintAges("age on screen, at any moment", series, "any_moment_ms");
  fmt::print("  page over bare client: {:.2f} (p50); worst page's p95: {:.1f} ms\n",
             RatioToBare(series), median("worst_page_p95_ms"));
  fmt::print("  a page draws its map {:.1f} times/s and shows {:.1f} states/s of a robot\n",
             median("frames_per_s"), median("states_per_s"));
  fmt::print("  service: {:.1f} % of a core, {:.1f} MB; {:.0f} kB/s to each page\n",
             100.0 * median("service_cores"), median("service_mb"), median("connection_kb_per_s"));
  fmt::print(
      "  next to it on the same cores: browsers {:.0f} %, load {:.1f} %, bare client {:.1f} %\n",
      100.0 * median("browser_cores"), 100.0 * median("load_cores"), 100.0 * median("bare_cores"));
}

void PrintStall(const Json& stall) {
  const auto p95 = [&](const char* path) { return Figure(stall, path + std::string("/p95")); };
  fmt::print("\none of {} browsers stands still (SIGSTOP); before and meanwhile\n",
             stall["pages"].get<int>());
  fmt::print("  p95 of the others: {:.1f} -> {:.1f} ms; of the bare client: {:.1f} -> {:.1f} ms\n",
             p95("before/shown_ms"), p95("meanwhile/shown_ms"), p95("before/bare_ms"),
             p95("meanwhile/bare_ms"));
  fmt::print("  the service grows by: {:.2f} -> {:.2f} MB\n",
             Figure(stall, "before/service_grown_mb"), Figure(stall, "meanwhile/service_grown_mb"));
}

void PrintMoves(const Json& moves) {
  fmt::print("\nthe map of one of {} browsers is moved; between two frames (60 Hz at most)\n",
             moves["pages"].get<int>());
  for (const char* how : {"pan", "zoom"}) {
    const Json& times = moves[std::string(how) + "_ms"];
    fmt::print("  {:<4} p50 {:.1f}, p95 {:.1f}, most {:.1f} ms\n", how, times["p50"].get<double>(),
               times["p95"].get<double>(), times["max"].get<double>());
  }
  fmt::print("  processor time of the browser for a frame: {:.1f} ms\n",
             moves["cpu_ms"].get<double>());
}

/// What was played, what an age is, and a table for each number of pages.
void PrintTable(const Json& figures, const Options& options, int rounds, std::size_t bytes) {
  const Drive& drive = options.load.drive;
  fmt::print("{}, everything on it, medians of {} rounds of {:.0f} s\n", Machine(), rounds,
             options.seconds);
  fmt::print(
      "{} robots in a world of {} x {} cells: state at {:.0f} Hz each, map when a cell is "
      "entered,\n"
      "snapshot and frame of the live view at {:.1f} Hz each, JPEG of {:.1f} kB\n",
      drive.robots, drive.side, drive.side, options.load.state_hz, options.SnapshotRate(),
      static_cast<double>(bytes) / 1000.0);
  fmt::print(
      "age: from publishing a state on DDS until the animation frame after the one that drew it\n");
  for (const Json& series : figures["details"]) PrintSeries(series);
  if (figures.contains("moves")) PrintMoves(figures["moves"]);
  if (figures.contains("stall")) PrintStall(figures["stall"]);
  fmt::print("\n");
}

/// Prints each bar. Throws std::runtime_error when one is missed. The age counts up to four pages: eight
/// share the cores with everything else; the processor time of the fewest, which nobody starves.
void CheckBars(const Json& figures) {
  int missed = 0;
  const auto check = [&](const std::string& what, double value, double limit) {
    fmt::print("{}: {:.2f}, under {}: {}\n", what, value, limit, value < limit ? "met" : "MISSED");
    missed += value < limit ? 0 : 1;
  };
  for (const Json& series : figures["details"]) {
    const int pages = series["pages"];
    if (pages > 4) continue;
    check(fmt::format("p95 in the worst of {} page(s), ms", pages),
          MedianOf(series, "worst_page_p95_ms"), kAgeBarMs);
  }
  check("cores for a page, its browser included", figures["metrics"]["page_core_share"],
        kPageCoreBar);
  if (figures.contains("stall")) {
    check("cost of a stalled browser to the service, MB", GrownByStall(figures["stall"]),
          kStallBarMb);
  }
  if (missed > 0) throw std::runtime_error(fmt::format("{} bars missed", missed));
}

/// One browser stands still: the others, and the service, in as long a while before and meanwhile.
Json MeasureStall(Stage& stage, int pages, double seconds) {
  Json stall{{"pages", pages}, {"before", MeasureRound(stage, seconds, pages + 1)}};
  stage.browsers.Stop();
  stall["meanwhile"] = MeasureRound(stage, seconds, pages);
  stage.browsers.Continue();
  return stall;
}

/// The first page's map is panned and zoomed under the load.
Json MeasureMoves(Stage& stage, int pages, double seconds) {
  const MapMoves moves = stage.browsers.Move(seconds);
  return {{"pages", pages},
          {"pan_ms", Quantiles(moves.pan_ms)},
          {"zoom_ms", Quantiles(moves.zoom_ms)},
          {"cpu_ms", moves.cpu_ms}};
}

void AddMetrics(const Json& series, Json& metrics) {
  const std::string prefix = fmt::format("pages{}_", series["pages"].get<int>());
  for (const auto& [name, path] :
       {std::pair("p50_ms", "shown_ms/p50"), std::pair("p95_ms", "shown_ms/p95"),
        std::pair("worst_page_p95_ms", "worst_page_p95_ms"),
        std::pair("bare_p95_ms", "bare_ms/p95"), std::pair("service_cores", "service_cores"),
        std::pair("service_mb", "service_mb")}) {
    metrics[prefix + name] = MedianOf(series, path);
  }
  metrics[prefix + "bare_ratio"] = RatioToBare(series);
}

void Run(const BenchProgram& program, Options options) {
  const test::TemporaryFolder folder;
  const auto domain = test::LeaseDomain();
  std::sort(options.pages.begin(), options.pages.end());
  options.load.drive.begin_s = WallSeconds();
  const Drive& drive = options.load.drive;
  ConsoleService service(folder.path(), drive, domain.domain());
  bus::Participant participant("bench_console", test::OnLoopback("", domain.domain()));
  Load load(participant, options.load);
  BareClient bare(service.port(), drive, RobotName(0));
  Browsers browsers(folder.path());
  Stage stage{load, service, bare, browsers};
  Json figures{{"robots", drive.robots},
               {"side", drive.side},
               {"state_hz", options.load.state_hz},
               {"picture_hz", options.SnapshotRate()},
               {"seconds", options.seconds}};
  for (const int pages : options.pages) {
    browsers.Open(service.url(), pages, drive);
    Json series{{"pages", pages}};
    program.ForEachRound(
        [&] { series["rounds"].push_back(MeasureRound(stage, options.seconds, pages + 1)); });
    AddMetrics(series, figures["metrics"]);
    if (!figures["metrics"].contains("page_core_share")) {
      figures["metrics"]["page_core_share"] = MedianOf(series, "browser_cores") / pages;
    }
    figures["details"].push_back(std::move(series));
    if (options.move_s == 0.0 || figures.contains("moves")) continue;
    const Json moves = MeasureMoves(stage, pages, options.move_s);
    figures["metrics"]["pan_p95_ms"] = Figure(moves, "pan_ms/p95");
    figures["metrics"]["zoom_p95_ms"] = Figure(moves, "zoom_ms/p95");
    figures["metrics"]["move_cpu_ms"] = Figure(moves, "cpu_ms");
    figures["moves"] = moves;
  }
  const int most = options.pages.back();
  if (options.stall_s > 0.0 && most > 1) {
    const Json stall = MeasureStall(stage, most, options.stall_s);
    figures["metrics"]["stall_grown_mb"] = GrownByStall(stall);
    figures["metrics"]["stall_others_ratio"] =
        Figure(stall, "meanwhile/shown_ms/p95") / Figure(stall, "before/shown_ms/p95");
    figures["stall"] = stall;
  }
  if (bare.ended()) throw StartupError("the service has closed the bare client");
  PrintTable(figures, options, program.rounds(), load.image_bytes());
  program.Write(figures);
  CheckBars(figures);
}

void AddOptions(BenchProgram& program, Options& options) {
  Drive& drive = options.load.drive;
  program.AddNumber("--seconds", options.seconds, "Length of a round", 0.5, 600.0);
  program.app()
      .add_option("--pages", options.pages, "Numbers of browsers, such as 1,8")
      ->delimiter(',')
      ->capture_default_str()
      ->check(Between(1, 30));
  program.AddNumber("--robots", drive.robots, "Robots", 1, 26);
  program.AddNumber("--side", drive.side, "Cells on each side of their world", 28, 1000);
  program.AddNumber("--state-hz", options.load.state_hz, "States of each robot", 1.0, 1000.0);
  program.AddNumber("--picture-hz", options.load.snapshot_hz,
                    "Pictures of each robot; each comes with a state", 0.1, 100.0);
  program.AddNumber(
      "--move", options.move_s,
      "s for which a page's map is panned and zoomed, with the fewest browsers; 0 = not at all",
      0.0, 60.0);
  // Under 20 s: then the service gives such a page up.
  program.AddNumber("--stall", options.stall_s,
                    "s for which the last of several browsers is stopped; 0 = not at all", 0.0,
                    18.0);
}

}  // namespace
}  // namespace conav::bench

int main(int argc, char** argv) {
  using namespace conav::bench;
  BenchProgram program(
      "conav bench console",
      "Age of the states that the console shows: the operator service with its page in real "
      "headless browsers, fed over DDS as simulators do it, next to a bare WebSocket "
      "client; its cost to the service; and the cost of a browser that hangs, to the service and "
      "the "
      "others.",
      5);
  Options options;
  AddOptions(program, options);
  return program.Run(argc, argv, [&] { Run(program, options); });
}
