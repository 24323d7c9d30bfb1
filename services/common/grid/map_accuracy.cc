#include "common/grid/map_accuracy.h"

#include <algorithm>

namespace conav {
namespace {

void Demand(const OccupancyGrid& truth, int rows, int columns) {
  DEMAND(truth.rows() == rows && truth.columns() == columns, truth.rows(), truth.columns(), rows,
         columns);
}

void FinishRatios(MapAccuracy& accuracy, int right_now) {
  const int gained = std::max(0, accuracy.corrected - accuracy.broken);
  if (accuracy.wrong_at_first > 0) {
    accuracy.mapping = static_cast<double>(gained) / accuracy.wrong_at_first;
  } else {
    accuracy.mapping = accuracy.broken == 0 ? 1.0 : 0.0;
  }
  if (accuracy.editable_cells > 0) {
    accuracy.cell = static_cast<double>(right_now) / accuracy.editable_cells;
  }
}

}  // namespace

MapAccuracy CompareMaps(const OccupancyGrid& truth, const OccupancyGrid& initial,
                        const BeliefGrid& belief) {
  Demand(truth, initial.rows(), initial.columns());
  Demand(truth, belief.rows(), belief.columns());
  MapAccuracy accuracy;
  int right_now = 0;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    const Occupancy actual = truth.values()[i];
    if (truth.OnBorder(truth.CellAt(i)) || actual == Occupancy::kUnknown) continue;
    const bool wall = actual == Occupancy::kOccupied;
    const bool right = (belief.values()[i] >= kWallThreshold) == wall;
    const bool was_right = (initial.values()[i] != Occupancy::kFree) == wall;
    ++accuracy.editable_cells;
    right_now += right ? 1 : 0;
    accuracy.wrong_at_first += was_right ? 0 : 1;
    accuracy.corrected += right && !was_right ? 1 : 0;
    accuracy.broken += !right && was_right ? 1 : 0;
  }
  FinishRatios(accuracy, right_now);
  return accuracy;
}

BeliefGrid ToBelief(const OccupancyGrid& map) {
  BeliefGrid belief(map.rows(), map.columns());
  for (std::size_t i = 0; i < map.size(); ++i) {
    switch (map.values()[i]) {
      case Occupancy::kFree:
        belief.values()[i] = 0.0F;
        break;
      case Occupancy::kOccupied:
        belief.values()[i] = 1.0F;
        break;
      case Occupancy::kUnknown:
        belief.values()[i] = 0.5F;
        break;
    }
  }
  return belief;
}

OccupancyGrid ToOccupancy(const BeliefGrid& belief) {
  OccupancyGrid map(belief.rows(), belief.columns());
  std::ranges::transform(belief.values(), map.values().begin(), [](float wall) {
    return wall >= kWallThreshold ? Occupancy::kOccupied : Occupancy::kFree;
  });
  return map;
}

}  // namespace conav
