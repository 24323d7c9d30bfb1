#include "bench/console/report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "bench/support/measure.h"

namespace conav::bench {
namespace {

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

}  // namespace

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

}  // namespace conav::bench
