#pragma once

#include "planner/search/perception_model.h"

namespace conav::planner {

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
