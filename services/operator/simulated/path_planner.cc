#include "operator/simulated/path_planner.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <functional>
#include <numbers>
#include <numeric>
#include <queue>
#include <utility>

#include "common/runtime/config.h"

namespace conav::operators {

namespace {

constexpr std::array<Cell, 4> kDiagonalOffsets{Cell{-1, 1}, Cell{1, 1}, Cell{1, -1}, Cell{-1, -1}};

/// Of the two cells between diagonal neighbours, the one that is cheaper to enter.
Cell CornerBetween(Cell from, Cell to, const Grid<double>& entry_costs) {
  const Cell along_row{from.row, to.column};
  const Cell along_column{to.row, from.column};
  return entry_costs[along_column] < entry_costs[along_row] ? along_column : along_row;
}

}  // namespace

CostField::CostField(const Grid<double>& entry_costs, Cell source, bool diagonals)
    : source_(source),
      cost_(entry_costs.rows(), entry_costs.columns(), kUnreachable),
      previous_(entry_costs.rows(), entry_costs.columns(), source),
      corner_(entry_costs.rows(), entry_costs.columns(), source) {
  using Entry = std::pair<double, Cell>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open;
  cost_[source] = 0.0;
  open.push({0.0, source});
  const auto step = [&](Cell from, Cell by, Cell to, double cost) {
    if (!(cost < cost_[to])) return;
    cost_[to] = cost;
    previous_[to] = from;
    corner_[to] = by;
    open.push({cost, to});
  };
  while (!open.empty()) {
    const auto [cost, cell] = open.top();
    open.pop();
    if (cost > cost_[cell]) continue;
    for (const Cell offset : kNeighbourOffsets) {
      const Cell next = cell + offset;
      if (entry_costs.Contains(next)) step(cell, next, next, cost + entry_costs[next]);
    }
    if (!diagonals) continue;
    for (const Cell offset : kDiagonalOffsets) {
      const Cell next = cell + offset;
      if (!entry_costs.Contains(next)) continue;
      const Cell corner = CornerBetween(cell, next, entry_costs);
      const double dearer = std::max(entry_costs[next], entry_costs[corner]);
      step(cell, corner, next, cost + std::numbers::sqrt2 * dearer);
    }
  }
}

std::vector<Cell> CostField::PathTo(Cell cell) const {
  DEMAND(cost_[cell] < kUnreachable, cell, source_);
  std::vector<Cell> path{cell};
  while (path.back() != source_) {
    const Cell last = path.back();
    if (corner_[last] != last) path.push_back(corner_[last]);
    path.push_back(previous_[last]);
  }
  std::reverse(path.begin(), path.end());
  return path;
}

namespace {

constexpr std::size_t kExactGoals = 6;  // 720 orders

/// fields[0] starts at the robot, fields[i + 1] at goal i.
using Fields = std::vector<CostField>;
using Order = std::vector<std::size_t>;  // indices of goals

double TourCost(const Fields& fields, std::span<const Cell> goals, const Order& order) {
  double cost = 0.0;
  std::size_t from = 0;
  for (const std::size_t goal : order) {
    cost += fields[from].CostTo(goals[goal]);
    from = goal + 1;
  }
  return cost;
}

Order CheapestOrder(const Fields& fields, std::span<const Cell> goals) {
  Order order(goals.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  Order best = order;
  double best_cost = TourCost(fields, goals, order);
  while (std::next_permutation(order.begin(), order.end())) {
    const double cost = TourCost(fields, goals, order);
    if (cost < best_cost) {
      best_cost = cost;
      best = order;
    }
  }
  return best;
}

Order NearestNext(const Fields& fields, std::span<const Cell> goals) {
  Order order;
  Order left(goals.size());
  std::iota(left.begin(), left.end(), std::size_t{0});
  std::size_t from = 0;
  while (!left.empty()) {
    const auto nearest = std::min_element(left.begin(), left.end(), [&](auto a, auto b) {
      return fields[from].CostTo(goals[a]) < fields[from].CostTo(goals[b]);
    });
    order.push_back(*nearest);
    from = *nearest + 1;
    left.erase(nearest);
  }
  return order;
}

/// The cell that the map shows free and whose nearest goal is farthest.
Cell FarthestFromGoals(const Fields& fields, const BeliefGrid& belief) {
  Cell farthest;
  double most = -1.0;
  for (std::size_t i = 0; i < belief.size(); ++i) {
    const Cell cell = belief.CellAt(i);
    if (IsWall(belief, cell) || !(fields[0].CostTo(cell) < kUnreachable)) continue;
    double nearest = kUnreachable;
    for (std::size_t goal = 1; goal < fields.size(); ++goal) {
      nearest = std::min(nearest, fields[goal].CostTo(cell));
    }
    if (nearest <= most) continue;
    most = nearest;
    farthest = cell;
  }
  return farthest;
}

/// Cells to the nearest one that is 0 in `distances`, up to about 8 % off (a chamfer in two passes;
/// G. Borgefors, "Distance transformations in digital images", CVGIP 34, 1986).
void SpreadDistances(Grid<float>& distances) {
  constexpr float kDiagonal = 1.41421356F;
  const int rows = distances.rows();
  const int columns = distances.columns();
  const std::span<float> values = distances.values();
  const auto pass = [&](int row, int column, int sign) {
    const auto lower = [&](int row_offset, int column_offset, float step) {
      const Cell from{row + sign * row_offset, column + sign * column_offset};
      if (!distances.Contains(from)) return;
      float& value = values[distances.IndexOf({row, column})];
      value = std::min(value, values[distances.IndexOf(from)] + step);
    };
    lower(0, -1, 1.0F);
    lower(-1, -1, kDiagonal);
    lower(-1, 0, 1.0F);
    lower(-1, 1, kDiagonal);
  };
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) pass(row, column, 1);
  }
  for (int row = rows; row-- > 0;) {
    for (int column = columns; column-- > 0;) pass(row, column, -1);
  }
}

/// Adds what a step near the shore costs more: near walls of the map and cells never entered.
void AddShore(const BeliefGrid& belief, double cell_size_m, Grid<double>& costs) {
  Grid<float> distances(costs.rows(), costs.columns(), std::numeric_limits<float>::max());
  for (std::size_t i = 0; i < costs.size(); ++i) {
    const bool shore = belief.values()[i] >= kWallThreshold || !(costs.values()[i] < kUnreachable);
    if (shore) distances.values()[i] = 0.0F;
  }
  SpreadDistances(distances);
  for (std::size_t i = 0; i < costs.size(); ++i) {
    const double distance_m = static_cast<double>(distances.values()[i]) * cell_size_m;
    if (distance_m == 0.0 || distance_m >= kShoreM) continue;
    costs.values()[i] += kShoreCost * (1.0 - distance_m / kShoreM);
  }
}

Result<void> CheckInside(const BeliefGrid& belief, Cell cell, const char* what) {
  if (belief.Contains(cell)) return {};
  return Fail(ErrorCode::kOutOfRange,
              fmt::format("the {} {} lies outside of the belief map of {} x {} cells", what, cell,
                          belief.rows(), belief.columns()));
}

}  // namespace

void PathPlannerParameters::Visit(ConfigReader& reader) {
  reader.Field("wall_crossing_cost", wall_crossing_cost, 0.0, 1e6);
  reader.Choice("horizon", horizon, {"tour", "next_goal", "away"});
}

Grid<double> PathPlanner::EntryCosts(const BeliefGrid& belief,
                                     const std::set<Cell>& impassable) const {
  const double wall_cost =
      parameters_.wall_crossing_cost * (IsRaster(cell_size_m_) ? kLandCost : 1.0);
  Grid<double> costs(belief.rows(), belief.columns(), 1.0);
  for (std::size_t i = 0; i < belief.size(); ++i) {
    double& cost = costs.values()[i];
    if (belief.values()[i] >= kWallThreshold) cost += wall_cost;
    if (belief.OnBorder(belief.CellAt(i))) cost = kUnreachable;
  }
  for (const Cell cell : impassable) {
    if (costs.Contains(cell)) costs[cell] = kUnreachable;
  }
  if (IsRaster(cell_size_m_)) AddShore(belief, cell_size_m_, costs);
  return costs;
}

Result<std::vector<Cell>> PathPlanner::Plan(const BeliefGrid& belief,
                                            const std::set<Cell>& impassable, Cell start,
                                            std::span<const Cell> goals) const {
  if (auto inside = CheckInside(belief, start, "start"); !inside) {
    return tl::unexpected(inside.error());
  }
  const Grid<double> costs = EntryCosts(belief, impassable);
  const bool diagonals = IsRaster(cell_size_m_);
  Fields fields{CostField(costs, start, diagonals)};
  std::vector<Cell> reachable;
  for (const Cell goal : std::set<Cell>(goals.begin(), goals.end())) {
    if (auto inside = CheckInside(belief, goal, "goal"); !inside) {
      return tl::unexpected(inside.error());
    }
    if (!(fields[0].CostTo(goal) < kUnreachable)) continue;
    reachable.push_back(goal);
  }
  // A tour to one goal starts at the robot only.
  if (reachable.size() > 1 || parameters_.horizon == "away") {
    for (const Cell goal : reachable) fields.emplace_back(costs, goal, diagonals);
  }
  if (parameters_.horizon == "away" && !reachable.empty()) {
    return fields[0].PathTo(FarthestFromGoals(fields, belief));
  }
  Order order = reachable.size() <= kExactGoals ? CheapestOrder(fields, reachable)
                                                : NearestNext(fields, reachable);
  if (parameters_.horizon == "next_goal" && order.size() > 1) {
    order.erase(order.begin() + 1, order.end());
  }

  std::vector<Cell> path{start};
  std::size_t from = 0;
  for (const std::size_t goal : order) {
    const std::vector<Cell> leg = fields[from].PathTo(reachable[goal]);
    path.insert(path.end(), leg.begin() + 1, leg.end());
    from = goal + 1;
  }
  return path;
}

}  // namespace conav::operators
