#include "study/supervision_report.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <nlohmann/json.hpp>
#include <optional>

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

using Json = nlohmann::ordered_json;

/// Nothing was measured where all trials failed; one trial has no interval.
std::string FigureText(const SupervisionCell& cell, const SupervisionMeasure& measure) {
  if (cell.records.empty()) return "-";
  const std::string mean = fmt::format("{:.2f}", cell.Mean(measure));
  if (cell.records.size() < 2) return mean;
  return fmt::format("{} ±{:.2f}", mean, cell.HalfInterval(measure));
}

Json MeanJson(const SupervisionCell& cell, const SupervisionMeasure& measure) {
  return cell.records.empty() ? Json() : Json(cell.Mean(measure));
}

template <std::size_t kCount>
statistics::ReportSection CellSection(std::string title, const char* const (&keys)[kCount],
                                      const SupervisionSummary& summary) {
  statistics::ReportSection section;
  section.title = std::move(title);
  section.header = {"robots, order", "trials"};
  for (const char* key : keys) section.header.emplace_back(FindMeasure(key).header);
  for (const SupervisionCell& cell : summary.cells) {
    std::vector<std::string> row{fmt::format("{} {}", cell.robots, cell.order),
                                 fmt::format("{}", cell.records.size())};
    for (const char* key : keys) {
      row.push_back(FigureText(cell, FindMeasure(key)));
    }
    section.rows.push_back(std::move(row));
  }
  return section;
}

std::string PText(const std::optional<double>& p) {
  return p ? fmt::format("{:.4f}", *p) : std::string("-");
}

statistics::ReportSection ComparisonSection(const SupervisionSummary& summary) {
  statistics::ReportSection section;
  section.title = "Orders against each other, paired by seed";
  section.header = {"robots, measure", "first - second", "difference", "95 % interval", "p",
                    "p (Holm)"};
  for (const SupervisionComparison& comparison : summary.comparisons) {
    for (const statistics::Pair& pair : comparison.pairs) {
      section.rows.push_back(
          {fmt::format("{} {}", comparison.robots, comparison.measure->key),
           fmt::format("{} - {}", pair.first, pair.second),
           fmt::format("{:.3f}", pair.t.mean_difference),
           fmt::format("[{:.3f}, {:.3f}]", pair.t.interval.low, pair.t.interval.high),
           PText(pair.t.p), PText(pair.t_adjusted.holm)});
    }
  }
  section.remarks = {"Paired t tests; Holm's correction within each number of robots and measure."};
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
    json[fmt::format("{}_mean", measure.key)] = MeanJson(cell, measure);
    json[fmt::format("{}_half_interval", measure.key)] =
        cell.records.size() < 2 ? Json() : Json(cell.HalfInterval(measure));
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
  if (pair.t.p) json["p"] = *pair.t.p;
  if (pair.t_adjusted.holm) json["p_holm"] = *pair.t_adjusted.holm;
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
      csv += record.failure.empty() ? fmt::format(",{}", measure.value(record)) : ",";
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
          MeanJson(cell, FindMeasure(key));
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

std::string SupervisionPage(const SupervisionOptions& options, const SupervisionSummary& summary) {
  std::string page = statistics::PageHead("conav study --supervision");
  page += fmt::format("<h1>One operator, many robots</h1>\n<p>{}</p>\n",
                      SupervisionHeadline(options, summary));
  page += SupervisionPlot(options, summary);
  for (const auto& section : SupervisionSections(summary)) {
    page += statistics::SectionHtml(section);
  }
  return page + "</body>\n</html>\n";
}

}  // namespace conav::study
