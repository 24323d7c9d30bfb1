#pragma once

#include <optional>
#include <string>
#include <vector>

#include "nhpm/evaluation/evaluation.h"

namespace conav::nhpm {

/// A range of figures that other test sets of the same size may give.
struct Interval {
  double low = 0.0;
  double high = 0.0;
};

/// A figure that must be reached.
struct Bar {
  std::string key;   // in JSON
  std::string text;  // what is measured, for people
  double value = 0.0;
  double limit = 0.0;
  bool at_most = true;  // otherwise: more than the limit
  std::optional<Interval> interval;

  bool passed() const { return at_most ? value <= limit : value > limit; }
};

/// NHPM's loss above the oracle may be this share of GLPF-Test's loss above the oracle.
inline constexpr double kLargestExcessShare = 0.20;

/// The loss of `model` above that of `oracle`, as a share of what `baseline` has above it; infinite
/// where the baseline is no worse than the oracle. 0 = as good as the oracle, 1 = as the baseline.
double ExcessShare(double model, double oracle, double baseline);

/// 90 % of the excess shares when the trajectories are drawn again with replacement (percentile
/// bootstrap, 2000 draws, seeded). Nothing for fewer than two trajectories.
std::optional<Interval> ExcessShareInterval(const EvaluationData& data, const ModelRow& model,
                                            const ModelRow& oracle, const ModelRow& baseline);

/// Whether bars were set for the test part: synthetic people only.
bool HasBars(const EvaluationData& data);

/// What NHPM (the row of key "nhpm") must reach, of what the rows allow to say: the share of the
/// loss needs the oracle, the IoU a GLPF. Empty without NHPM, and where there are no bars.
std::vector<Bar> CheckBars(const EvaluationData& data, const std::vector<ModelRow>& rows);

/// The row of that key, or nullptr.
const ModelRow* FindRow(const std::vector<ModelRow>& rows, const std::string& key);

}  // namespace conav::nhpm
