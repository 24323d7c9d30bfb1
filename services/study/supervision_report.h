#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "study/report_page.h"
#include "study/statistics/analysis.h"
#include "study/supervision.h"

namespace conav::study {

/// One figure of a trial.
struct SupervisionMeasure {
  const char* key;  // in JSON and CSV
  const char* header;
  const char* title;
  std::optional<double> (*value)(const SupervisionRecord&);  // empty: not measured in the trial
};

/// goals_per_minute, waiting_s, waiting_p95_s, value_lost_per_minute, abandoned, utilisation,
/// interaction_s, neglect_s, attended_robots and the predictions of the last four from NT and IT:
/// fan_out, fan_out_with_waits (both at most the number of robots), queue_attended_robots,
/// queue_utilisation, queue_waiting_s (finite-source queue M/M/1//N); pace. Without a request there
/// is no wait, without an answer no IT, without a robot that asked twice no NT, and without both no
/// prediction.
const std::vector<SupervisionMeasure>& SupervisionMeasures();
/// The measure with that key.
const SupervisionMeasure& FindMeasure(const std::string& key);

/// All trials of one number of robots in one order.
struct SupervisionCell {
  int robots = 1;
  std::string order;
  std::vector<const SupervisionRecord*> records;  // measured ones, by seed
  /// Over the trials that measured it; empty if there are none.
  std::optional<double> Mean(const SupervisionMeasure& measure) const;
  /// Half of the 95 % interval of the mean (Student); empty for fewer than two.
  std::optional<double> HalfInterval(const SupervisionMeasure& measure) const;
};

/// Compares the orders for one number of robots, paired by seed; leaves out seeds without all
/// orders. No pairs for fewer than two seeds or orders.
struct SupervisionComparison {
  int robots = 1;
  const SupervisionMeasure* measure = nullptr;
  std::vector<statistics::Pair> pairs;
};

/// Below this pace the machine was too slow: answers took simulation time that the operator did not
/// need.
inline constexpr double kLeastPace = 0.9;

struct SupervisionSummary {
  std::vector<SupervisionCell> cells;  // by robots, then order, as given
  std::vector<SupervisionComparison> comparisons;
  std::vector<const SupervisionRecord*> failed;
  std::vector<const SupervisionRecord*> slow;  // measured, below kLeastPace
};

/// `records` outlive it.
SupervisionSummary Summarise(const SupervisionOptions& options,
                             const std::vector<SupervisionRecord>& records);

/// "SIMULATED operator: 5 team sizes x 3 orders x 10 seeds = 150 trials of 3 min, ...".
std::string SupervisionHeadline(const SupervisionOptions& options,
                                const SupervisionSummary& summary);

/// The table, measured against predicted, the orders against each other, the failures.
std::vector<ReportSection> SupervisionSections(const SupervisionSummary& summary);

std::string SupervisionText(const SupervisionOptions& options, const SupervisionSummary& summary);

/// A line per trial: robots, order, seed, every measure; an unmeasured value is empty.
std::string SupervisionCsv(const std::vector<SupervisionRecord>& records);

/// `cells` (robots, order, trials, <measure>_mean, <measure>_half_interval), `comparisons`,
/// `failed`, `slow`, and `metrics` with <measure>_<order>_<robots> for goals_per_minute, waiting_s,
/// value_lost_per_minute, utilisation and attended_robots. Unmeasured values are null: means
/// without a measured trial, intervals of fewer than two, p if all seeds differ by the same.
nlohmann::ordered_json SupervisionJson(const SupervisionOptions& options,
                                       const SupervisionSummary& summary);

/// Throughput, waiting time, utilisation and fan-out over the number of robots, a line per order
/// with its 95 % interval, predictions dashed. An SVG document.
std::string SupervisionPlot(const SupervisionOptions& options, const SupervisionSummary& summary);

/// One self-contained page; `made` is a ProvenanceSection().
std::string SupervisionPage(const SupervisionOptions& options, const SupervisionSummary& summary,
                            const ReportSection& made);

}  // namespace conav::study
