#include "planner/search/goal_distance.h"

#include <algorithm>
#include <functional>
#include <limits>
#include <queue>
#include <utility>

namespace conav::planner {
namespace {

constexpr double kUnreachable = std::numeric_limits<double>::infinity();

struct EdgeInto {
  VertexId from;
  double steps;
};

std::vector<std::vector<EdgeInto>> EdgesIntoVertices(const NavigationGraph& graph) {
  std::vector<std::vector<EdgeInto>> edges(static_cast<std::size_t>(graph.vertex_count()));
  for (VertexId from = 0; from < graph.vertex_count(); ++from) {
    for (const Edge& edge : graph.EdgesFrom(from)) {
      edges[static_cast<std::size_t>(edge.target)].push_back({from, 1.0 / edge.feasibility});
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
  const auto edges_into = EdgesIntoVertices(problem.graph);
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

}  // namespace conav::planner
