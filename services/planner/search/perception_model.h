#pragma once

#include <span>
#include <string>
#include <vector>

#include "common/msg/planning.h"
#include "common/runtime/result.h"

namespace conav::planner {

/// The seam between the planner and whatever predicts the operator's edits: embedded, remote over
/// DDS, cached, fake. Owned by the planner, which is its consumer.
///
/// Shapes:  one answer per query, in order; grids as large as the query's belief.
/// Errors:  kInvalidArgument (a query that no model can answer), kTimeout, kUnavailable. Never
///          throws. An empty batch gives an empty answer.
/// Threads: safe to call concurrently. Blocks until the whole batch is answered or the model gives
///          up.
/// Source:  paper section 4, F_theta(x, tau, o); every model behind it gives equal bits for equal
///          queries.
class PerceptionModel {
 public:
  virtual ~PerceptionModel() = default;

  [[nodiscard]] virtual Result<std::vector<PerceptionAnswer>> Predict(
      std::span<const PerceptionQuery> queries) = 0;

  /// Name of the model that answers, for reports.
  virtual std::string name() const = 0;

  /// Changes when another model answers from now on (another name or other weights): answers that
  /// were remembered from before are no longer its answers. Where it is the same before and after
  /// Predict(), it is the one that answered.
  virtual std::string identity() const { return name(); }
};

/// A perception model for tests, lives beside its interface. The operator mends a cell that a
/// picture shows and that the belief has wrong with probability near_probability * exp(-decay *
/// distance in cells), and a wall on the robot's path with path_probability. Deterministic; needs
/// no truth, as it looks at belief, path and view only.
class FakePerceptionModel final : public PerceptionModel {
 public:
  struct Options {
    double near_probability = 0.6;
    double decay = 0.15;
    double path_probability = 0.9;
  };

  FakePerceptionModel() = default;
  explicit FakePerceptionModel(const Options& options) : options_(options) {}

  [[nodiscard]] Result<std::vector<PerceptionAnswer>> Predict(
      std::span<const PerceptionQuery> queries) override;
  std::string name() const override { return "fake"; }

 private:
  PerceptionAnswer Answer(const PerceptionQuery& query) const;

  Options options_;
};

}  // namespace conav::planner
