#include "planner/search/path_state.h"

#include <algorithm>
#include <functional>
#include <limits>
#include <optional>
#include <queue>
#include <utility>

#include "common/grid/geometry.h"
#include "common/grid/map_accuracy.h"
#include "common/runtime/result.h"

namespace conav::planner {
namespace {

constexpr double kUnreachable = std::numeric_limits<double>::infinity();

struct EdgeInto {
  VertexId from;
  double steps;
};

/// How often a step into `vertex` counts that may fail.
double DoubtOf(const SearchProblem& problem, VertexId vertex) {
  if (problem.believed_wall_steps == 1.0) return 1.0;
  const auto cells = problem.graph.CellsOf(vertex);
  const auto walls = std::ranges::count_if(
      cells, [&](Cell cell) { return problem.belief[cell] >= kWallThreshold; });
  const double share = static_cast<double>(walls) / static_cast<double>(cells.size());
  return 1.0 + share * (problem.believed_wall_steps - 1.0);
}

/// How often a step into each vertex counts for where the operator's path leads.
std::vector<double> DetoursOf(const SearchProblem& problem) {
  const auto vertices = static_cast<std::size_t>(problem.graph.vertex_count());
  std::vector<double> detours(vertices,
                              problem.guidance.empty() ? 1.0 : problem.off_guidance_steps);
  for (const Cell cell : problem.guidance) {
    if (const auto vertex = problem.graph.VertexAt(cell)) {
      detours[static_cast<std::size_t>(*vertex)] = 1.0;
    }
  }
  return detours;
}

std::vector<std::vector<EdgeInto>> EdgesIntoVertices(const SearchProblem& problem) {
  const NavigationGraph& graph = problem.graph;
  const std::vector<double> detours = DetoursOf(problem);
  std::vector<std::vector<EdgeInto>> edges(detours.size());
  for (VertexId from = 0; from < graph.vertex_count(); ++from) {
    for (const Edge& edge : graph.EdgesFrom(from)) {
      const double doubt = edge.feasibility < 1.0 ? DoubtOf(problem, edge.target) : 1.0;
      const auto target = static_cast<std::size_t>(edge.target);
      edges[target].push_back({from, detours[target] * doubt * edge.length / edge.feasibility});
    }
  }
  return edges;
}

void ReplaceUnreachable(std::vector<double>& steps) {
  double farthest = -1.0;
  for (const double value : steps) {
    if (value != kUnreachable) farthest = std::max(farthest, value);
  }
  std::replace(steps.begin(), steps.end(), kUnreachable, farthest + 1.0);
}

}  // namespace

std::vector<double> StepsToNearestGoal(const SearchProblem& problem) {
  const auto edges_into = EdgesIntoVertices(problem);
  std::vector<double> steps(edges_into.size(), kUnreachable);
  using Item = std::pair<double, VertexId>;
  std::priority_queue<Item, std::vector<Item>, std::greater<>> queue;  // Dijkstra from the goals
  for (const Cell goal : problem.goals_left) {
    const auto vertex = problem.graph.VertexAt(goal);
    if (!vertex || *vertex == problem.start) continue;
    steps[static_cast<std::size_t>(*vertex)] = 0.0;
    queue.emplace(0.0, *vertex);
  }
  while (!queue.empty()) {
    const auto [so_far, vertex] = queue.top();
    queue.pop();
    if (so_far > steps[static_cast<std::size_t>(vertex)]) continue;
    for (const EdgeInto& edge : edges_into[static_cast<std::size_t>(vertex)]) {
      double& known = steps[static_cast<std::size_t>(edge.from)];
      if (so_far + edge.steps >= known) continue;
      known = so_far + edge.steps;
      queue.emplace(known, edge.from);
    }
  }
  ReplaceUnreachable(steps);
  return steps;
}

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
  std::optional<Cell> previous;
  for (const Cell cell : problem.path) {
    const auto vertex = graph_.VertexAt(cell);
    if (!vertex) {
      other_cells_.push_back(cell);
      ++length_;
    } else if (!previous || *previous == cell || graph_.VertexAt(*previous) != vertex) {
      Enter(*vertex);
    }
    previous = cell;
  }
  const bool ends_at_start =
      !problem.path.empty() && (problem.path.back() == graph_.CellOf(problem.start) ||
                                graph_.VertexAt(problem.path.back()) == problem.start);
  if (!ends_at_start) Enter(problem.start);
  steps_.push_back({.vertex = problem.start});
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
