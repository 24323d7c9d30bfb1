#pragma once

#include <vector>

#include "planner/search/search_problem.h"

namespace conav::planner {

/// Expected number of steps from each vertex to the nearest goal left, other than the start, by
/// what the robot knows: a step that may fail counts as 1 / feasibility. Where no goal can be
/// reached the number is that of the farthest vertex plus one, 0 if there is none.
std::vector<double> StepsToNearestGoal(const SearchProblem& problem);

}  // namespace conav::planner
