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
      const SupervisionMeasure& measure = FindMeasure(key);
      row.push_back(fmt::format("{:.2f} ±{:.2f}", cell.Mean(measure), cell.HalfInterval(measure)));
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
  nlohmann::ordered_json json{{"simulated", true},
                              {"headline", SupervisionHeadline(options, summary)},
                              {"cells", nlohmann::ordered_json::array()},
                              {"comparisons", nlohmann::ordered_json::array()},
                              {"failed", nlohmann::ordered_json::array()},
                              {"slow", nlohmann::ordered_json::array()},
                              {"metrics", nlohmann::ordered_json::object()}};
  for (const SupervisionCell& cell : summary.cells) {
    nlohmann::ordered_json entry{
        {"robots", cell.robots}, {"order", cell.order}, {"trials", cell.records.size()}};
    for (const SupervisionMeasure& measure : SupervisionMeasures()) {
      entry[fmt::format("{}_mean", measure.key)] = cell.Mean(measure);
      entry[fmt::format("{}_half_interval", measure.key)] = cell.HalfInterval(measure);
    }
    json["cells"].push_back(std::move(entry));
    for (const char* key : {"goals_per_minute", "waiting_s", "value_lost_per_minute", "utilisation",
                            "attended_robots"}) {
      json["metrics"][fmt::format("{}_{}_{}", key, cell.order, cell.robots)] =
          cell.Mean(FindMeasure(key));
    }
  }
  for (const SupervisionComparison& comparison : summary.comparisons) {
    for (const statistics::Pair& pair : comparison.pairs) {
      nlohmann::ordered_json entry{{"robots", comparison.robots},
                                   {"measure", comparison.measure->key},
                                   {"first", pair.first},
                                   {"second", pair.second},
                                   {"mean_difference", pair.t.mean_difference},
                                   {"low", pair.t.interval.low},
                                   {"high", pair.t.interval.high}};
      if (pair.t.p) entry["p"] = *pair.t.p;
      if (pair.t_adjusted.holm) entry["p_holm"] = *pair.t_adjusted.holm;
      json["comparisons"].push_back(std::move(entry));
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
