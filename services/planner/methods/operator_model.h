#pragma once

#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "common/msg/perception_model.h"
#include "common/msg/planning.h"

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
/// Cells count as edits in a maze. On a raster (IsRaster) an area is one edit: so many cells count
/// as one as a square of EditSide() has, or else one missed picture would outweigh all others.
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
  void Received(const BeliefGrid& belief, const OccupancyGrid& known, double cell_size_m = 2.0);

  /// Since the last received map a picture was sent, to which the model expects `edits`. Call
  /// before the answer is received.
  void Sent(PerceptionAnswer edits) { expected_edits_ = std::move(edits); }

  /// In [0, 1]; 1 at first.
  double value() const { return (prior_edits_ + shown_) / (prior_edits_ + expected_); }

 private:
  void Compare(const BeliefGrid& belief, const OccupancyGrid& known, double cell_size_m);

  double prior_edits_;
  double expected_ = 0.0;
  double shown_ = 0.0;
  std::optional<BeliefGrid> belief_;                // received last
  std::optional<PerceptionAnswer> expected_edits_;  // to the picture sent since then
};

/// The operator's map of one world as the planner guesses it when it does not look at the published
/// one: the published map as first received, changed by the edits that the perception model
/// expects after each picture of this planner's robots,
///
///   x <- x (1 - p_remove) + (1 - x) p_add
///
/// Source:  paper sections 4 and 5.1 (x is estimated with F_theta); docs/paper.md A13.
/// Threads: safe to use from several, one per robot.
class BeliefEstimate {
 public:
  /// `starts_unknown`: with a map of which nothing is known instead of the published one.
  explicit BeliefEstimate(std::shared_ptr<PerceptionModel> model, bool starts_unknown = false)
      : model_(std::move(model)), starts_unknown_(starts_unknown) {}

  /// The estimate; the first call starts it with `published`, and so does one with a map of another
  /// size: that world restarted.
  BeliefGrid Now(const BeliefGrid& published);

  /// A picture was sent: from `cell` towards `heading_rad`, after the robot went `path`, showing
  /// `visible`. Errors: those of the model; the estimate is unchanged then. Requires Now() before.
  [[nodiscard]] Result<void> NoteSent(std::vector<Cell> path, Cell cell, double heading_rad,
                                      VisibleCells visible);

 private:
  std::shared_ptr<PerceptionModel> model_;
  const bool starts_unknown_;
  std::mutex mutex_;  // guards belief_
  std::optional<BeliefGrid> belief_;
};

/// Remembers which views a robot has sent, and on what belief: none is offered again while the
/// operator's map is unchanged in the cells that it shows, because the same picture would change
/// nothing the second time. Without this rule the reward lets the planner send one view for ever
/// (facts measured in the search experiment).
class SentViews {
 public:
  struct View {
    Cell cell;
    double heading_rad = 0.0;
    bool operator==(const View&) const = default;
  };

  /// The robot sends this view now. Its belief is taken at the next Update(), after the operator's
  /// answer.
  void Sent(const View& view, VisibleCells visible);

  /// The belief as it is at the next decision: views whose cells changed since are offered again.
  void Update(const BeliefGrid& belief);

  /// Views that must not be offered now.
  std::vector<View> Withheld() const;

 private:
  struct Entry {
    View view;
    std::vector<Cell> cells;
    std::vector<float> belief;  // of `cells` after the answer; empty until then
  };

  std::vector<Entry> entries_;
};

}  // namespace conav::planner
