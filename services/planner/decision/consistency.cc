#include "planner/decision/consistency.h"

#include <fmt/format.h>

#include <algorithm>

namespace conav::planner {
namespace {

std::optional<std::string> OutsideOf(const OccupancyGrid& map, const std::vector<Cell>& cells,
                                     std::string_view what) {
  const auto outside =
      std::find_if_not(cells.begin(), cells.end(), [&](Cell cell) { return map.Contains(cell); });
  if (outside == cells.end()) return std::nullopt;
  return fmt::format("{} {} is outside of the robot's {}x{} map", what, *outside, map.rows(),
                     map.columns());
}

template <class T>
std::optional<std::string> OtherSize(const OccupancyGrid& map, const Grid<T>& other,
                                     std::string_view what) {
  if (other.rows() == map.rows() && other.columns() == map.columns()) return std::nullopt;
  return fmt::format("{} has {}x{} cells, the robot's has {}x{}", what, other.rows(),
                     other.columns(), map.rows(), map.columns());
}

}  // namespace

std::optional<std::string> Inconsistency(const RobotInputs& inputs) {
  const RobotState& state = *inputs.state;
  const OccupancyGrid& map = inputs.map->cells;
  if (inputs.belief) {
    const BeliefGrid& belief = inputs.belief->wall_probability;
    if (auto text = OtherSize(map, belief, "the operator's map")) return text;
  }
  if (inputs.truth) {
    if (auto text = OtherSize(map, *inputs.truth, "the true map")) return text;
  }
  if (auto text = OutsideOf(map, {state.cell}, "its cell")) return text;
  if (auto text = OutsideOf(map, state.path, "cell of its path")) return text;
  if (auto text = OutsideOf(map, state.goals_left, "goal")) return text;
  if (inputs.guidance) {
    if (auto text = OutsideOf(map, inputs.guidance->path, "cell of its guidance")) return text;
  }
  if (map[state.cell] == Occupancy::kOccupied) {
    return fmt::format("its cell {} is a wall on its own map", state.cell);
  }
  return std::nullopt;
}

}  // namespace conav::planner
