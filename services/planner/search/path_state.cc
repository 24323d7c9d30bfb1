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
  if (problem.believed_wall_steps == 1) return 1.0;
  const auto cells = problem.graph.CellsOf(vertex);
  const auto walls = std::ranges::count_if(
      cells, [&](Cell cell) { return (*problem.belief)[cell] >= kWallThreshold; });
  const double share = static_cast<double>(walls) / static_cast<double>(cells.size());
  return 1.0 + share * (problem.believed_wall_steps - 1);
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
  std::vector<std::vector<EdgeInto>> edges(static_cast<std::size_t>(graph.vertex_count()));
  for (VertexId from = 0; from < graph.vertex_count(); ++from) {
    for (const Edge& edge : graph.EdgesFrom(from)) {
      const auto target = static_cast<std::size_t>(edge.target);
      const double doubt = edge.feasibility < 1.0 ? DoubtOf(problem, edge.target) : 1.0;
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

std::vector<double> StepsToNearest(const SearchProblem& problem,
                                   const std::vector<VertexId>& goals) {
  const auto edges_into = EdgesIntoVertices(problem);
  std::vector<double> steps(edges_into.size(), kUnreachable);
  using Item = std::pair<double, VertexId>;
  std::priority_queue<Item, std::vector<Item>, std::greater<>> queue;  // Dijkstra from the goals
  for (const VertexId goal : goals) {
    steps[static_cast<std::size_t>(goal)] = 0.0;
    queue.emplace(0.0, goal);
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

/// The goals left but the start, by vertex, each once.
std::vector<VertexId> GoalVertices(const SearchProblem& problem) {
  std::vector<VertexId> goals;
  for (const Cell goal : problem.goals_left) {
    const auto vertex = problem.graph.VertexAt(goal);
    if (vertex && *vertex != problem.start) goals.push_back(*vertex);
  }
  std::sort(goals.begin(), goals.end());
  goals.erase(std::unique(goals.begin(), goals.end()), goals.end());
  return goals;
}

class AllSteps final : public StepsToGoals {
 public:
  explicit AllSteps(std::vector<double> steps) : steps_(std::move(steps)) {}
  double From(VertexId vertex) override { return steps_[static_cast<std::size_t>(vertex)]; }

 private:
  std::vector<double> steps_;
};

}  // namespace

std::unique_ptr<StepsToGoals> NavigationGraph::StepsTo(const SearchProblem& problem,
                                                       std::vector<VertexId> goals) const {
  return std::make_unique<AllSteps>(StepsToNearest(problem, goals));
}

PathState::PathState(const SearchProblem& problem, int steps_expected)
    : graph_(problem.graph),
      start_heading_rad_(problem.heading_rad),
      vertices_(Index(problem.graph.vertex_count())),
      passed_(Index(problem.graph.uncertainty_count())),
      steps_to_goal_(Index(problem.graph.vertex_count())),
      guided_before_(problem.guided_before || !problem.guidance.empty()) {
  DEMAND(problem.start >= 0 && problem.start < problem.graph.vertex_count(), problem.start);
  steps_.reserve(Index(steps_expected) + 1);
  ReadGuidance(problem);
  ReadPath(problem);
  std::vector<VertexId> goals = GoalVertices(problem);
  for (const VertexId goal : goals) vertices_[Index(goal)].is_goal = true;
  goals_left_ = static_cast<int>(goals.size());
  steps_to_goals_ = graph_.StepsTo(problem, std::move(goals));
}

namespace {

/// Sorts them and leaves each once.
void SortOut(std::vector<Cell>& cells) {
  std::sort(cells.begin(), cells.end());
  cells.erase(std::unique(cells.begin(), cells.end()), cells.end());
}

}  // namespace

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
    } else if (!std::exchange(vertices_[Index(*vertex)].is_guidance, true)) {
      ++unvisited_guidance_;
    }
  }
  SortOut(outside);
  unvisited_guidance_ += static_cast<int>(outside.size());
}

void PathState::ReadPath(const SearchProblem& problem) {
  std::optional<Cell> previous;
  for (const Cell cell : problem.path) {
    const auto vertex = graph_.VertexAt(cell);
    if (!vertex) {
      first_cells_.push_back(cell);
      ++length_;
    } else if (!previous || *previous == cell || graph_.VertexAt(*previous) != vertex) {
      Enter(*vertex);
    }
    if (vertex) AppendCellsOf(*vertex, first_cells_);
    previous = cell;
  }
  const bool ends_at_start =
      !problem.path.empty() && (problem.path.back() == graph_.CellOf(problem.start) ||
                                graph_.VertexAt(problem.path.back()) == problem.start);
  if (!ends_at_start) Enter(problem.start);
  steps_.push_back({.vertex = problem.start});
  AppendCellsOf(problem.start, first_cells_);
  SortOut(first_cells_);
}

void PathState::AppendCellsOf(VertexId vertex, std::vector<Cell>& cells) const {
  const auto of_vertex = graph_.CellsOf(vertex);
  cells.insert(cells.end(), of_vertex.begin(), of_vertex.end());
}

void PathState::CollectCells(std::vector<Cell>& cells) const {
  cells.clear();
  for (const Step& step : steps_) AppendCellsOf(step.vertex, cells);
  SortOut(cells);
  const auto entered = static_cast<std::ptrdiff_t>(cells.size());
  cells.insert(cells.end(), first_cells_.begin(), first_cells_.end());
  std::inplace_merge(cells.begin(), cells.begin() + entered, cells.end());
  cells.erase(std::unique(cells.begin(), cells.end()), cells.end());
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
