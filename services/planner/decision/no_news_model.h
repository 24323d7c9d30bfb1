#pragma once

#include "planner/search/perception_model.h"

namespace conav::planner {

/// Pictures that change nothing, so that a search with this model moves for the task's sake alone;
/// for methods in which something else decides on pictures. Never fails.
class NoNewsModel final : public PerceptionModel {
 public:
  [[nodiscard]] Result<std::vector<PerceptionAnswer>> Predict(
      std::span<const PerceptionQuery> queries) override;
  std::string name() const override { return "none"; }
};

}  // namespace conav::planner
