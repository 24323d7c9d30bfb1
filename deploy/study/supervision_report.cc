#include "study/supervision_report.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>

#include "common/svg/svg_canvas.h"

namespace conav::study {
namespace {

constexpr const char* kTableKeys[] = {"goals_per_minute",      "waiting_s", "waiting_p95_s",
                                      "value_lost_per_minute", "abandoned", "utilisation",
                                      "interaction_s",         "neglect_s"};
constexpr const char* kFanOutKeys[] = {"attended_robots", "fan_out", "fan_out_with_waits",
                                       "queue_attended_robots"};
constexpr const char* kQueueKeys[] = {"utilisation", "queue_utilisation", "waiting_s",
                                      "queue_waiting_s"};

constexpr const char* kMetricKeys[] = {"goals_per_minute", "waiting_s", "value_lost_per_minute",
                                       "utilisation", "attended_robots"};

constexpr const char* kWhyNone =
    "-: no trial measured it: NT needs a robot that asks a second time, IT an answer, predictions "
    "need both.";

using Json = nlohmann::ordered_json;

std::string FigureText(const SupervisionCell& cell, const SupervisionMeasure& measure) {
  const auto mean = cell.Mean(measure);
  if (!mean) return "-";
  const auto half = cell.HalfInterval(measure);
  return half ? fmt::format("{:.2f} ±{:.2f}", *mean, *half) : fmt::format("{:.2f}", *mean);
}

/// What does not exist, or is infinite, is null.
Json NumberJson(const std::optional<double>& value) {
  return value && std::isfinite(*value) ? Json(*value) : Json();
}

template <std::size_t kCount>
statistics::ReportSection CellSection(std::string title, const char* const (&keys)[kCount],
                                      const SupervisionSummary& summary) {
  statistics::ReportSection section;
  section.title = std::move(title);
  section.header = {"robots, order", "trials"};
  for (const char* key : keys) section.header.emplace_back(FindMeasure(key).header);
  bool lacks_figures = false;
  for (const SupervisionCell& cell : summary.cells) {
    std::vector<std::string> row{fmt::format("{} {}", cell.robots, cell.order),
                                 fmt::format("{}", cell.records.size())};
    for (const char* key : keys) {
      row.push_back(FigureText(cell, FindMeasure(key)));
      if (row.back() == "-" && !cell.records.empty()) lacks_figures = true;
    }
    section.rows.push_back(std::move(row));
  }
  if (lacks_figures) section.remarks = {kWhyNone};
  return section;
}

/// Without spread there is no test, whatever its formula gives.
bool HasTest(const statistics::Pair& pair) { return pair.t.t && std::isfinite(*pair.t.t); }

std::string PText(const statistics::Pair& pair, const std::optional<double>& p) {
  return p && HasTest(pair) ? fmt::format("{:.4f}", *p) : std::string("-");
}

statistics::ReportSection ComparisonSection(const SupervisionSummary& summary) {
  statistics::ReportSection section;
  section.title = "Orders against each other, paired by seed";
  section.header = {"robots, measure", "first - second", "difference", "95 % interval", "p",
                    "p (Holm)"};
  bool lacks_tests = false;
  for (const SupervisionComparison& comparison : summary.comparisons) {
    for (const statistics::Pair& pair : comparison.pairs) {
      section.rows.push_back(
          {fmt::format("{} {}", comparison.robots, comparison.measure->key),
           fmt::format("{} - {}", pair.first, pair.second),
           fmt::format("{:.3f}", pair.t.mean_difference),
           fmt::format("[{:.3f}, {:.3f}]", pair.t.interval.low, pair.t.interval.high),
           PText(pair, pair.t.p), PText(pair, pair.t_adjusted.holm)});
      lacks_tests = lacks_tests || !HasTest(pair);
    }
  }
  section.remarks = {"Paired t tests; Holm's correction within each number of robots and measure."};
  if (lacks_tests) {
    section.remarks.push_back("-: the difference is the same for every seed: nothing to test.");
  }
  return section;
}

statistics::ReportSection SlowSection(const SupervisionSummary& summary) {
  statistics::ReportSection section;
  section.title = "Trials in which the machine did not keep pace";
  section.header = {"trial", "share of --speed"};
  for (const SupervisionRecord* record : summary.slow) {
    section.rows.push_back({record->trial.name(), fmt::format("{:.2f}", record->pace)});
  }
  section.remarks = {"They are in the tables. A lower --speed or an idle machine mends it."};
  return section;
}

statistics::ReportSection FailedSection(const SupervisionSummary& summary) {
  statistics::ReportSection section;
  section.title = "Trials that failed";
  section.header = {"trial", "why"};
  for (const SupervisionRecord* record : summary.failed) {
    section.rows.push_back({record->trial.name(), record->failure});
  }
  return section;
}

Json CellJson(const SupervisionCell& cell) {
  Json json{{"robots", cell.robots}, {"order", cell.order}, {"trials", cell.records.size()}};
  for (const SupervisionMeasure& measure : SupervisionMeasures()) {
    json[fmt::format("{}_mean", measure.key)] = NumberJson(cell.Mean(measure));
    json[fmt::format("{}_half_interval", measure.key)] = NumberJson(cell.HalfInterval(measure));
  }
  return json;
}

Json PairJson(const SupervisionComparison& comparison, const statistics::Pair& pair) {
  Json json{{"robots", comparison.robots},
            {"measure", comparison.measure->key},
            {"first", pair.first},
            {"second", pair.second},
            {"mean_difference", pair.t.mean_difference},
            {"low", pair.t.interval.low},
            {"high", pair.t.interval.high}};
  json["p"] = HasTest(pair) ? NumberJson(pair.t.p) : Json();
  json["p_holm"] = HasTest(pair) ? NumberJson(pair.t_adjusted.holm) : Json();
  return json;
}

}  // namespace

std::string SupervisionHeadline(const SupervisionOptions& options,
                                const SupervisionSummary& summary) {
  std::size_t measured = 0;
  for (const SupervisionCell& cell : summary.cells) measured += cell.records.size();
  const auto& times = options.interaction;
  return fmt::format(
      "SIMULATED operator: robots {}, orders {}, {} seeds; {} trials of {} min of simulation time "
      "measured, {} failed. Methods {}; interaction times: picture {} s, blocked {} s, path {} s, "
      "log-normal with log-sd {}.",
      fmt::join(options.robots, " "), fmt::join(options.orders, " "), options.seeds, measured,
      options.minutes, summary.failed.size(), fmt::join(options.methods, " "), times.picture_s,
      times.blocked_s, times.path_s, times.log_sd);
}

std::vector<statistics::ReportSection> SupervisionSections(const SupervisionSummary& summary) {
  std::vector<statistics::ReportSection> sections{
      CellSection("Measured: mean over seeds ± half of its 95 % interval", kTableKeys, summary),
      CellSection("Fan-out: measured and predicted", kFanOutKeys, summary),
      CellSection("Utilisation and waiting: measured and predicted", kQueueKeys, summary)};
  if (!summary.comparisons.empty()) sections.push_back(ComparisonSection(summary));
  if (!summary.slow.empty()) sections.push_back(SlowSection(summary));
  if (!summary.failed.empty()) sections.push_back(FailedSection(summary));
  return sections;
}

std::string SupervisionText(const SupervisionOptions& options, const SupervisionSummary& summary) {
  std::string text = SupervisionHeadline(options, summary) + "\n";
  for (const auto& section : SupervisionSections(summary)) {
    text += statistics::SectionText(section);
  }
  return text;
}

std::string SupervisionCsv(const std::vector<SupervisionRecord>& records) {
  std::string csv = "robots,order,seed";
  for (const SupervisionMeasure& measure : SupervisionMeasures())
    csv += fmt::format(",{}", measure.key);
  csv += ",wall_s\n";
  for (const SupervisionRecord& record : records) {
    csv += fmt::format("{},{},{}", record.trial.robots, record.trial.order, record.trial.seed);
    for (const SupervisionMeasure& measure : SupervisionMeasures()) {
      const auto value = record.is_complete() ? measure.value(record) : std::nullopt;
      csv += value ? fmt::format(",{}", *value) : ",";
    }
    csv += fmt::format(",{}\n", record.wall_s);
  }
  return csv;
}

nlohmann::ordered_json SupervisionJson(const SupervisionOptions& options,
                                       const SupervisionSummary& summary) {
  Json json{{"simulated", true},        {"headline", SupervisionHeadline(options, summary)},
            {"cells", Json::array()},   {"comparisons", Json::array()},
            {"failed", Json::array()},  {"slow", Json::array()},
            {"metrics", Json::object()}};
  for (const SupervisionCell& cell : summary.cells) {
    json["cells"].push_back(CellJson(cell));
    for (const char* key : kMetricKeys) {
      json["metrics"][fmt::format("{}_{}_{}", key, cell.order, cell.robots)] =
          NumberJson(cell.Mean(FindMeasure(key)));
    }
  }
  for (const SupervisionComparison& comparison : summary.comparisons) {
    for (const statistics::Pair& pair : comparison.pairs) {
      json["comparisons"].push_back(PairJson(comparison, pair));
    }
  }
  for (const SupervisionRecord* record : summary.slow) {
    json["slow"].push_back({{"trial", record->trial.name()}, {"pace", record->pace}});
  }
  for (const SupervisionRecord* record : summary.failed) {
    json["failed"].push_back({{"trial", record->trial.name()}, {"why", record->failure}});
  }
  return json;
}

std::string SupervisionPage(const SupervisionOptions& options, const SupervisionSummary& summary,
                            const statistics::ReportSection& made) {
  std::string page = statistics::PageHead("One operator, many robots");
  page += fmt::format("<p>{}</p>\n<div class=\"wide\" tabindex=\"0\">\n{}</div>\n",
                      EscapeXml(SupervisionHeadline(options, summary)),
                      SupervisionPlot(options, summary));
  for (const auto& section : SupervisionSections(summary)) {
    page += statistics::SectionHtml(section);
  }
  return page + statistics::SectionHtml(made) + "</body>\n</html>\n";
}

}  // namespace conav::study
