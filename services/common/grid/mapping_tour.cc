#include "common/grid/mapping_tour.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/grid/geometry.h"
#include "common/grid/map_accuracy.h"

namespace conav {
namespace {

std::vector<Cell> WrongCells(const OccupancyGrid& truth, const BeliefGrid& belief) {
  std::vector<Cell> wrong;
  for (std::size_t i = 0; i < belief.size(); ++i) {
    const Cell cell = belief.CellAt(i);
    const bool wall = truth[cell] == Occupancy::kOccupied;
    if (wall != (belief[cell] >= kWallThreshold)) wrong.push_back(cell);
  }
  return wrong;
}

Result<void> RequireRange(const char* what, double value, double low, double high) {
  if (value >= low && value <= high) return {};
  return Fail(ErrorCode::kInvalidArgument,
              fmt::format("{} = {} is not in [{}, {}]", what, value, low, high));
}

}  // namespace

Result<void> CheckMappingTourOptions(const MappingTourOptions& options) {
  constexpr double kLargest = std::numeric_limits<double>::max();
  return RequireRange("headings", options.headings, 1, 360)
      .and_then([&] { return RequireRange("background", options.background, 0.0, kLargest); })
      .and_then([&] {
        return RequireRange("attraction_cells", options.attraction_cells, 0.0, kLargest);
      });
}

MappingTour::MappingTour(std::vector<Cell> goals, const MappingTourOptions& options,
                         std::uint64_t seed)
    : options_(options), random_(seed), goals_(std::move(goals)) {
  DEMAND(CheckMappingTourOptions(options).has_value(), options.headings, options.background,
         options.attraction_cells);
  random_.Shuffle(goals_);
}

MappingStop MappingTour::Next(const OccupancyGrid& truth, const BeliefGrid& belief, Cell at) {
  DEMAND(truth.rows() == belief.rows() && truth.columns() == belief.columns(), truth.rows(),
         belief.rows());
  const std::set<Cell> reached = ReachableCells(truth, at);
  while (next_goal_ < goals_.size() && !reached.contains(goals_[next_goal_])) ++next_goal_;
  const Cell target = next_goal_ < goals_.size()
                          ? goals_[next_goal_++]
                          : DrawTarget(truth, belief, {reached.begin(), reached.end()}, at);
  return {target, DrawHeading()};
}

Cell MappingTour::DrawTarget(const OccupancyGrid& truth, const BeliefGrid& belief,
                             const std::vector<Cell>& reachable, Cell at) {
  const std::vector<Cell> wrong = WrongCells(truth, belief);
  std::vector<double> weights;
  double total = 0.0;
  for (const Cell cell : reachable) {
    weights.push_back(cell == at ? 0.0 : Attraction(cell, wrong));
    total += weights.back();
  }
  const auto last = static_cast<std::int64_t>(reachable.size()) - 1;
  if (total == 0.0) return reachable[static_cast<std::size_t>(random_.Uniform(0, last))];
  double rest = random_.Unit() * total;
  std::size_t chosen = 0;
  while (chosen + 1 < weights.size() && rest >= weights[chosen]) rest -= weights[chosen++];
  return reachable[chosen];
}

double MappingTour::Attraction(Cell cell, const std::vector<Cell>& wrong) const {
  const auto near = std::count_if(wrong.begin(), wrong.end(), [&](Cell other) {
    const Cell way = other - cell;
    return std::hypot(way.row, way.column) <= options_.attraction_cells;
  });
  return options_.background + static_cast<double>(near);
}

double MappingTour::DrawHeading() {
  return HeadingFromIndex(static_cast<int>(random_.Uniform(0, options_.headings - 1)),
                          options_.headings);
}

}  // namespace conav
