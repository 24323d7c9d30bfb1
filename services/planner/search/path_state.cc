#include "planner/search/path_state.h"

#include <algorithm>

#include "common/grid/geometry.h"
#include "common/runtime/demand.h"
#include "planner/search/goal_distance.h"

namespace conav::planner {

PathState::PathState(const SearchProblem& problem, int steps_expected)
    : graph_(problem.graph),
      start_heading_rad_(problem.heading_rad),
      visits_(Index(problem.graph.vertex_count())),
      visited_((visits_.size() + 63) / 64),
      passed_(Index(problem.graph.uncertainty_count())),
      is_goal_(visits_.size()),
      is_guidance_(visits_.size()),
      steps_to_goal_(StepsToNearestGoal(problem)),
      guided_before_(problem.guided_before || !problem.guidance.empty()) {
  DEMAND(problem.start >= 0 && problem.start < problem.graph.vertex_count(), problem.start);
  steps_.reserve(Index(steps_expected) + 1);
  ReadGuidance(problem);
  ReadPath(problem);
  for (const Cell goal : problem.goals_left) {
    const auto vertex = problem.graph.VertexAt(goal);
    if (!vertex || *vertex == problem.start || is_goal_[Index(*vertex)] != 0) continue;
    is_goal_[Index(*vertex)] = 1;
    ++goals_left_;
  }
}

double PathState::heading_rad() const {
  for (std::size_t i = steps_.size(); i-- > 1;) {
    const VertexId from = steps_[i - 1].vertex;
    const VertexId to = steps_[i].vertex;
    if (from != to) return HeadingTowards(graph_.CellOf(from), graph_.CellOf(to));
  }
  return start_heading_rad_;
}

void PathState::ReadGuidance(const SearchProblem& problem) {
  std::vector<Cell> outside;
  for (const Cell cell : problem.guidance) {
    const auto vertex = problem.graph.VertexAt(cell);
    if (!vertex) {
      outside.push_back(cell);
    } else if (is_guidance_[Index(*vertex)] == 0) {
      is_guidance_[Index(*vertex)] = 1;
      ++unvisited_guidance_;
    }
  }
  std::sort(outside.begin(), outside.end());
  outside.erase(std::unique(outside.begin(), outside.end()), outside.end());
  unvisited_guidance_ += static_cast<int>(outside.size());
}

void PathState::ReadPath(const SearchProblem& problem) {
  for (const Cell cell : problem.path) {
    if (const auto vertex = problem.graph.VertexAt(cell)) {
      Enter(*vertex);
    } else {
      other_cells_.push_back(cell);
      ++length_;
    }
  }
  const Cell start = problem.graph.CellOf(problem.start);
  if (problem.path.empty() || problem.path.back() != start) Enter(problem.start);
  steps_.push_back({problem.start, -1});
}

void PathState::TakeBack(std::size_t steps) {
  DEMAND(steps <= this->steps(), steps, this->steps());
  while (this->steps() > steps) {
    const Step step = steps_.back();
    steps_.pop_back();
    Leave(step.vertex);
    if (step.uncertainty >= 0) --passed_[Index(step.uncertainty)];
  }
}

}  // namespace conav::planner
