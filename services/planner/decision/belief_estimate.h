#pragma once

#include <memory>
#include <mutex>
#include <optional>

#include "planner/search/perception_model.h"

namespace conav::planner {

/// The operator's map of one world as the planner guesses it when it does not look at the published
/// one: the published map as it was first heard, changed by the edits that the perception model
/// expects after each picture of this planner's robots,
///
///   x <- x (1 - p_remove) + (1 - x) p_add
///
/// Source:  paper sections 4 and 5.1 (x is estimated with F_theta); docs/paper.md A13.
/// Threads: safe to use from several, one per robot.
class BeliefEstimate {
 public:
  explicit BeliefEstimate(std::shared_ptr<PerceptionModel> model) : model_(std::move(model)) {}

  /// The estimate; the first call starts it with `published`, and so does one with a map of another
  /// size: that world began anew.
  BeliefGrid Now(const BeliefGrid& published);

  /// A picture was sent: from `cell` towards `heading_rad`, after the robot went `path`, showing
  /// `visible`. Errors: those of the model; the estimate is unchanged then. Requires Now() before.
  [[nodiscard]] Result<void> NoteSent(std::vector<Cell> path, Cell cell, double heading_rad,
                                      VisibleCells visible);

 private:
  std::shared_ptr<PerceptionModel> model_;
  std::mutex mutex_;  // guards belief_
  std::optional<BeliefGrid> belief_;
};

}  // namespace conav::planner
