#include "planner/methods/region_navigation.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <queue>
#include <utility>

#include "planner/decision/traffic.h"
#include "planner/navigation/cell_line.h"

namespace conav::planner {
namespace {

/// The middle of a cell next to an obstacle is this far from it; a robot that drives along the
/// middles of cells comes no nearer.
constexpr double kNextToObstacle = 1.0;
/// Lines may come this much nearer than that, so that one beside a straight shore is straight.
constexpr double kSlack = 0.1;
constexpr double kBodySlack = 0.05;
/// Kept between robots besides their bodies, each of which has a margin already.
constexpr double kBetweenRobotsM = 0.25;

/// What a place off the vertex must save at least, by its distance from it.
constexpr double kToVertex = 0.05;

std::size_t At(VertexId vertex) { return static_cast<std::size_t>(vertex); }

int SquaredDistance(Cell a, Cell b) {
  const Cell way = a - b;
  return way.row * way.row + way.column * way.column;
}

double Distance(Cell a, Cell b) { return std::sqrt(SquaredDistance(a, b)); }

/// Of the cells' centres, in cells.
double DistanceToLine(Cell cell, Cell from, Cell to) {
  const Cell way = to - from;
  const Cell offset = cell - from;
  const double along = way.row * offset.row + way.column * offset.column;
  const double share = from == to ? 0.0 : std::clamp(along / SquaredDistance(from, to), 0.0, 1.0);
  return std::hypot(offset.row - share * way.row, offset.column - share * way.column);
}

/// Of the cell's square and the line, in cells.
double SquareToLine(Cell cell, Cell from, Cell to) {
  const auto to_square = [cell](double row, double column) {
    return std::hypot(std::max(std::abs(row - cell.row) - 0.5, 0.0),
                      std::max(std::abs(column - cell.column) - 0.5, 0.0));
  };
  const Cell way = to - from;
  double nearest = std::min(to_square(from.row, from.column), to_square(to.row, to.column));
  if (from == to) return nearest;
  for (const double down : {-0.5, 0.5}) {
    for (const double right : {-0.5, 0.5}) {
      const double row = cell.row + down - from.row;
      const double column = cell.column + right - from.column;
      const double along = way.row * row + way.column * column;
      const double share = std::clamp(along / SquaredDistance(from, to), 0.0, 1.0);
      nearest = std::min(nearest, std::hypot(row - share * way.row, column - share * way.column));
    }
  }
  return nearest;  // 0.5 at most where the line crosses the square
}

/// Vertices after `start` on the shortest way to one that is a goal, by length alone.
template <class IsGoal>
std::vector<VertexId> ShortestWay(const NavigationGraph& graph, VertexId start, IsGoal&& is_goal) {
  std::vector<double> lengths(At(graph.vertex_count()), std::numeric_limits<double>::infinity());
  std::vector<VertexId> before(lengths.size(), start);
  using Item = std::pair<double, VertexId>;
  std::priority_queue<Item, std::vector<Item>, std::greater<>> queue;  // Dijkstra
  lengths[At(start)] = 0.0;
  queue.emplace(0.0, start);
  while (!queue.empty()) {
    const auto [length, vertex] = queue.top();
    queue.pop();
    if (length > lengths[At(vertex)]) continue;
    if (is_goal(vertex)) {
      std::vector<VertexId> way;
      for (VertexId at = vertex; at != start; at = before[At(at)]) way.push_back(at);
      std::reverse(way.begin(), way.end());
      return way;
    }
    for (const Edge& edge : graph.EdgesFrom(vertex)) {
      double& known = lengths[At(edge.target)];
      if (length + edge.length >= known) continue;
      known = length + edge.length;
      before[At(edge.target)] = vertex;
      queue.emplace(known, edge.target);
    }
  }
  return {};
}

}  // namespace

RegionNavigation::RegionNavigation(const RegionOptions& options)
    : options_(options),
      body_cells_(options.clearance_cells > 0.0 ? options.clearance_cells - 0.5 - kBodySlack : 0.0),
      margin_cells_(std::max(options.clearance_cells, kNextToObstacle) - kSlack) {}

void RegionNavigation::Prepare(const OccupancyGrid& map) {
  if (graph_) graph_->Update(map, taken_);
}

void RegionNavigation::Update(const Situation& situation,
                              const std::shared_ptr<const GridViews>& views) {
  if (!graph_ || views_ != views) graph_.emplace(options_, views);
  views_ = views;
  taken_ = TakenCells(situation);
  graph_->Update(situation.map.cells, taken_);
}

bool RegionNavigation::MayBeFree(Cell cell) const {
  return graph_->known()[cell] != Occupancy::kOccupied;
}

std::optional<Cell> RegionNavigation::TraversableNear(Cell cell) const {
  const OccupancyGrid& known = graph_->known();
  if (graph_->VertexAt(cell)) return cell;
  if (IsKnownWall(known, cell)) return std::nullopt;
  const std::vector<Cell> way = PathToNearest(
      known, cell, [&](Cell at) { return MayBeFree(at); },
      [&](Cell at) { return graph_->VertexAt(at).has_value(); });
  return way.empty() ? std::nullopt : std::optional(way.back());
}

std::optional<VertexId> RegionNavigation::VertexNear(Cell cell) const {
  const auto traversable = TraversableNear(cell);
  return traversable ? graph_->VertexAt(*traversable) : std::nullopt;
}

std::vector<Cell> RegionNavigation::Traversable(std::vector<Cell> cells) const {
  for (Cell& cell : cells) cell = TraversableNear(cell).value_or(cell);
  return cells;
}

std::vector<Cell> RegionNavigation::FollowablePath(const std::vector<Cell>& path) const {
  std::vector<Cell> followable;
  std::optional<VertexId> before;
  for (const Cell cell : Traversable(path)) {
    const auto vertex = graph_->VertexAt(cell);
    if (before && vertex && before != vertex) {
      const auto is_next = [&](VertexId other) { return other == *vertex; };
      const std::vector<VertexId> way = ShortestWay(*graph_, *before, is_next);
      if (way.size() <= kMostBridged + 1) {  // the last is the path's own
        for (std::size_t i = 0; i + 1 < way.size(); ++i) {
          followable.push_back(graph_->CellOf(way[i]));
        }
      }
    }
    followable.push_back(cell);
    before = vertex;
  }
  return followable;
}

std::optional<Decision> RegionNavigation::ApproachGoal(const Situation& situation) const {
  const Cell here = situation.state.cell;
  const auto vertex = VertexNear(here);
  if (!vertex) return std::nullopt;
  std::optional<Cell> nearest;
  for (const Cell goal : situation.state.goals_left) {
    if (VertexNear(goal) != vertex) continue;
    if (!nearest || SquaredDistance(goal, here) < SquaredDistance(*nearest, here)) nearest = goal;
  }
  if (!nearest) return std::nullopt;
  // To a goal within the clearance of an obstacle as near as that allows, then to the goal itself.
  const Cell place = TraversableNear(*nearest).value();
  Decision decision = MoveAlong(situation, std::vector{place == here ? *nearest : place});
  return decision.action ? std::optional(std::move(decision)) : std::nullopt;
}

std::vector<Cell> RegionNavigation::WayToGoal(const Situation& situation) const {
  const auto start = VertexNear(situation.state.cell);
  if (!start) return {};
  std::vector<VertexId> goals;
  for (const Cell goal : situation.state.goals_left) {
    if (const auto vertex = VertexNear(goal)) goals.push_back(*vertex);
  }
  const auto is_goal = [&](VertexId vertex) {
    return std::ranges::find(goals, vertex) != goals.end();
  };
  std::vector<Cell> cells;
  for (const VertexId vertex : ShortestWay(*graph_, *start, is_goal)) {
    cells.push_back(graph_->CellOf(vertex));
  }
  return cells;
}

Decision RegionNavigation::MoveAlong(const Situation& situation,
                                     std::span<const Cell> vertices) const {
  const Cell target = vertices.size() < 2 ? vertices.front()
                                          : PlaceOnTheWay(situation.state.cell, vertices.front(),
                                                          vertices.subspan(1).front());
  std::vector<Cell> route = RouteTo(situation, target);
  if (route.empty()) return {};
  Decision decision = planner::MoveAlong({target});
  decision.plan = route;
  decision.plan.insert(decision.plan.end(), vertices.begin() + 1, vertices.end());
  decision.action->route = std::move(route);
  return decision;
}

/// Of the region of `vertex`: where the way from `here` to `next` is shortest, all but for being near
/// to the vertex.
Cell RegionNavigation::PlaceOnTheWay(Cell here, Cell vertex, Cell next) const {
  const auto region = graph_->VertexAt(vertex);
  if (!region) return vertex;
  const auto length = [&](Cell cell) {
    return Distance(here, cell) + Distance(cell, next) + kToVertex * Distance(cell, vertex);
  };
  const auto was_seen = [&](Cell cell) {
    return graph_->known()[cell] == Occupancy::kFree && graph_->VertexAt(cell).has_value();
  };
  Cell best = vertex;
  for (const Cell cell : graph_->CellsOf(*region)) {
    if (cell == here || length(cell) >= length(best)) continue;
    if (IsClear(here, cell, was_seen) && IsClear(cell, next, was_seen)) best = cell;
  }
  return best;
}

std::vector<Cell> RegionNavigation::RouteTo(const Situation& situation, Cell target) const {
  const auto is_traversable = [&](Cell cell) {
    return cell == target || graph_->VertexAt(cell).has_value();
  };
  const Cell here = situation.state.cell;
  const auto start = TraversableNear(here);
  if (!start) return {};
  std::vector<Cell> route;
  // A robot that an obstacle stopped stands somewhere in its cell.
  if (situation.state.command_outcome == CommandOutcome::kBlocked) route.push_back(here);
  AddCorners(
      here, *start, [&](Cell cell) { return MayBeFree(cell); }, route);
  const std::size_t corners = route.size();
  if (body_cells_ > 0.0) {  // around other robots, if there is room
    const double apart = 2.0 * body_cells_ + kBetweenRobotsM / situation.map.cell_size_m;
    const auto is_apart = [&](Cell cell) {
      return std::ranges::all_of(taken_, [&](Cell robot) {
        const double distance = std::sqrt(SquaredDistance(cell, robot));
        return distance >= apart || distance >= std::sqrt(SquaredDistance(*start, robot));
      });
    };
    AddCorners(
        *start, target, [&](Cell cell) { return is_traversable(cell) && is_apart(cell); }, route);
  }
  if (route.size() == corners) AddCorners(*start, target, is_traversable, route);
  if (route.empty()) route.push_back(target);  // stands in its cell, but perhaps not in the middle
  return route.back() == target ? route : std::vector<Cell>{};
}

/// Of a shortest path, with lines as long as they can be; none if there is no path.
template <class Passable>
void RegionNavigation::AddCorners(Cell from, Cell to, Passable&& passable,
                                  std::vector<Cell>& route) const {
  if (from == to) return;
  if (IsClear(from, to, passable)) return route.push_back(to);
  const std::vector<Cell> path =
      PathToNearest(graph_->known(), from, passable, [&](Cell cell) { return cell == to; });
  for (std::size_t next = 0; next < path.size();) {
    std::size_t end = path.size() - 1;
    while (end > next && !IsClear(from, path[end], passable)) --end;
    route.push_back(from = path[end]);
    next = end + 1;
  }
}

template <class Passable>
bool RegionNavigation::IsClear(Cell from, Cell to, Passable&& passable) const {
  return WalkLine(from, to,
                  [&](Cell cell) { return passable(cell) && !IsNearObstacle(cell, from, to); });
}

/// Whether an occupied cell around `cell`, which is on the line, is too near to the line.
bool RegionNavigation::IsNearObstacle(Cell cell, Cell from, Cell to) const {
  const OccupancyGrid& known = graph_->known();
  const int reach = static_cast<int>(std::ceil(std::max(margin_cells_, body_cells_ + 0.5)));
  for (int row = -reach; row <= reach; ++row) {
    for (int column = -reach; column <= reach; ++column) {
      const Cell other = cell + Cell{row, column};
      if (!known.Contains(other) || MayBeFree(other)) continue;
      const bool is_near = body_cells_ > 0.0 ? SquareToLine(other, from, to) < body_cells_
                                             : DistanceToLine(other, from, to) < margin_cells_;
      if (is_near) return true;
    }
  }
  return false;
}

}  // namespace conav::planner
