#include "common/grid/map_accuracy.h"

#include <catch2/catch.hpp>

namespace conav {
namespace {

constexpr Occupancy kFree = Occupancy::kFree;
constexpr Occupancy kWall = Occupancy::kOccupied;

/// 3 x 6 with the border as walls: four editable cells in the middle row.
OccupancyGrid Row4(Occupancy a, Occupancy b, Occupancy c, Occupancy d) {
  OccupancyGrid map(3, 6, kWall);
  map[{1, 1}] = a;
  map[{1, 2}] = b;
  map[{1, 3}] = c;
  map[{1, 4}] = d;
  return map;
}

const OccupancyGrid& Truth() {
  static const OccupancyGrid truth = Row4(kFree, kFree, kWall, kWall);
  return truth;
}

const OccupancyGrid& Initial() {  // cells 2 and 3 wrong
  static const OccupancyGrid initial = Row4(kFree, kWall, kFree, kWall);
  return initial;
}

TEST_CASE("each corrected cell counts by its share of the wrong ones, a broken one takes it back",
          "[grid]") {
  struct Row {
    OccupancyGrid map;
    int corrected;
    int broken;
    double mapping;
    double cell;
  };
  for (const Row& row :
       {Row{Initial(), 0, 0, 0.0, 0.5}, Row{Row4(kFree, kFree, kFree, kWall), 1, 0, 0.5, 0.75},
        Row{Truth(), 2, 0, 1.0, 1.0}, Row{Row4(kWall, kFree, kFree, kWall), 1, 1, 0.0, 0.5},
        Row{Row4(kWall, kWall, kFree, kFree), 0, 2, 0.0, 0.0}}) {
    const MapAccuracy accuracy = CompareMaps(Truth(), Initial(), ToBelief(row.map));
    CHECK(accuracy.editable_cells == 4);
    CHECK(accuracy.wrong_at_first == 2);
    CHECK(accuracy.corrected == row.corrected);
    CHECK(accuracy.broken == row.broken);
    CHECK(accuracy.mapping == row.mapping);
    CHECK(accuracy.cell == row.cell);
  }
  // A right map that stays right, and one that is broken.
  CHECK(CompareMaps(Truth(), Truth(), ToBelief(Truth())).mapping == 1.0);
  CHECK(CompareMaps(Truth(), Truth(), ToBelief(Initial())).mapping == 0.0);
}

TEST_CASE("border cells and unknown truth do not count", "[grid]") {
  OccupancyGrid truth = Truth();
  truth[{1, 1}] = Occupancy::kUnknown;
  OccupancyGrid initial = Initial();
  initial[{0, 0}] = kFree;
  CHECK(CompareMaps(truth, initial, ToBelief(initial)).editable_cells == 3);
  CHECK(CompareMaps(truth, initial, ToBelief(initial)).wrong_at_first == 2);
}

TEST_CASE("an unknown cell is believed to be a wall by one half, which is a wall on a map",
          "[grid]") {
  BeliefGrid belief = ToBelief(Row4(kFree, kWall, Occupancy::kUnknown, kFree));
  CHECK(belief[{1, 1}] == 0.0F);
  CHECK(belief[{1, 2}] == 1.0F);
  CHECK(belief[{1, 3}] == 0.5F);
  CHECK(CompareMaps(Truth(), Initial(), belief).corrected == 1);  // (1,3), a wall by one half
  belief[{1, 3}] = 0.49F;
  CHECK(CompareMaps(Truth(), Initial(), belief).corrected == 0);
  CHECK(ToOccupancy(belief) == Row4(kFree, kWall, kFree, kFree));
  belief[{1, 3}] = 0.5F;
  CHECK(ToOccupancy(belief)[{1, 3}] == kWall);
}

}  // namespace
}  // namespace conav
