#pragma once

#include <utility>
#include <vector>

#include "planner/search/path_state.h"

namespace conav::test {

/// Steps from each vertex to the nearest goal left, all worked out at once, also on graphs that have a
/// quicker way.
inline std::vector<double> StepsToNearestGoal(const planner::SearchProblem& problem) {
  const planner::PathState path(problem);
  std::vector<planner::VertexId> goals;
  const auto end = static_cast<planner::VertexId>(problem.graph.vertex_count());
  for (planner::VertexId vertex = 0; vertex < end; ++vertex) {
    if (path.IsGoal(vertex)) goals.push_back(vertex);
  }
  const auto all = problem.graph.NavigationGraph::StepsTo(problem, std::move(goals));
  std::vector<double> steps;
  for (planner::VertexId vertex = 0; vertex < end; ++vertex) steps.push_back(all->From(vertex));
  return steps;
}

}  // namespace conav::test
