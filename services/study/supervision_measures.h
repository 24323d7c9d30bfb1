#pragma once

#include <optional>
#include <string>
#include <vector>

#include "study/statistics/pairs.h"
#include "study/supervision_options.h"
#include "study/supervision_player.h"

namespace conav::study {

/// One figure of a trial.
struct SupervisionMeasure {
  const char* key;  // in JSON and CSV
  const char* header;
  const char* title;
  std::optional<double> (*value)(
      const SupervisionRecord&);  // nothing: the trial did not measure it
};

/// goals_per_minute, waiting_s, waiting_p95_s, value_lost_per_minute, abandoned, utilisation,
/// interaction_s, neglect_s, attended_robots and the predictions of the last four from NT and IT:
/// fan_out, fan_out_with_waits (both at most the number of robots), queue_attended_robots,
/// queue_utilisation, queue_waiting_s (finite-source queue M/M/1//N); pace. Without a question there
/// is no wait, without an answer no IT, without a robot that asked twice no NT, and no prediction
/// without both.
const std::vector<SupervisionMeasure>& SupervisionMeasures();
/// One of them.
const SupervisionMeasure& FindMeasure(const std::string& key);

/// All trials of one number of robots in one order.
struct SupervisionCell {
  int robots = 1;
  std::string order;
  std::vector<const SupervisionRecord*> records;  // measured ones, by seed
  /// Of the trials that measured it; nothing where none did.
  std::optional<double> Mean(const SupervisionMeasure& measure) const;
  /// Half of the 95 % interval of the mean (Student); nothing for fewer than two.
  std::optional<double> HalfInterval(const SupervisionMeasure& measure) const;
};

/// Orders against each other for one number of robots, paired by seed; seeds without all orders are
/// left out. No pairs for fewer than two seeds or orders.
struct SupervisionComparison {
  int robots = 1;
  const SupervisionMeasure* measure = nullptr;
  std::vector<statistics::Pair> pairs;
};

/// Below this pace a machine was too slow: answers took simulation time that no operator needed.
inline constexpr double kLeastPace = 0.9;

struct SupervisionSummary {
  std::vector<SupervisionCell> cells;  // by robots, then order, as asked for
  std::vector<SupervisionComparison> comparisons;
  std::vector<const SupervisionRecord*> failed;
  std::vector<const SupervisionRecord*> slow;  // measured, below kLeastPace
};

/// `records` outlive it.
SupervisionSummary Summarise(const SupervisionOptions& options,
                             const std::vector<SupervisionRecord>& records);

}  // namespace conav::study
