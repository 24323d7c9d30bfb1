#pragma once

#include <optional>

#include "planner/search/perception_model.h"
#include "planner/search/search_problem.h"

namespace conav::planner {

/// A view from the robot's place, and what it is expected to change.
struct BestView {
  double heading_rad = 0.0;
  double information = 0.0;  // R_info: expected edits, in cells
  int views = 0;             // that were compared, each asked of the model
};

/// Of the views offered at the start of `problem` with `least_information` or more (expected edits,
/// in cells) the one with the largest information less `turn_cost` for each radian that the robot
/// turns, the first of equals; nothing where there is none. For who decides by other means than the
/// search that a picture is sent now. Errors: those of the model.
[[nodiscard]] Result<std::optional<BestView>> FindBestView(const SearchProblem& problem,
                                                           PerceptionModel& model,
                                                           double least_information = 0.0,
                                                           double turn_cost = 0.0);

}  // namespace conav::planner
