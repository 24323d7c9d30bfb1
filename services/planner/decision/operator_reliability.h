#pragma once

#include <optional>

#include "common/protocol/planning.h"

namespace conav::planner {

/// How much of what the perception model expects of an operator they do: measured with each
/// picture, and a weight for what further pictures are worth. An addition to the paper, whose
/// operator always means well (docs/paper.md).
///
/// Only cells count that the robot knows. Expected are the edits there that would put the map
/// right; shown is by how many more of these cells the published map is right from then on, below 0
/// where edits broke more than they mended:
///
///   reliability = (prior + shown) / (prior + expected),   -prior <= shown <= expected
///
/// `prior` are edits that an operator is trusted with before anything was measured. What lies back
/// more than kMemoryEdits expected edits fades. Edits between pictures count as well: an operator
/// who is sent none any more can win the trust back by mending the map.
class OperatorReliability {
 public:
  static constexpr double kMemoryEdits = 20.0;

  /// `prior_edits` > 0.
  explicit OperatorReliability(double prior_edits) : prior_edits_(prior_edits) {}

  /// The published map when the robot, which knows `known`, decides: after it sent a picture, with
  /// the answer to that.
  void Heard(const BeliefGrid& belief, const OccupancyGrid& known);

  /// Since the map that was heard last a picture was sent, to which the model expects `edits`. Call
  /// before the answer is heard.
  void Sent(PerceptionAnswer edits) { expected_edits_ = std::move(edits); }

  /// In [0, 1]; 1 at first.
  double value() const { return (prior_edits_ + shown_) / (prior_edits_ + expected_); }

 private:
  void Compare(const BeliefGrid& belief, const OccupancyGrid& known);

  double prior_edits_;
  double expected_ = 0.0;
  double shown_ = 0.0;
  std::optional<BeliefGrid> belief_;                // heard last
  std::optional<PerceptionAnswer> expected_edits_;  // to the picture sent since then
};

}  // namespace conav::planner
