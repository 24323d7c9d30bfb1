#include "common/grid/map_accuracy.h"

#include <catch2/catch.hpp>

namespace conav {
namespace {

constexpr Occupancy kFree = Occupancy::kFree;
constexpr Occupancy kWall = Occupancy::kOccupied;

/// 3 x 6 with the border as walls: four editable cells in the middle row.
OccupancyGrid Row(Occupancy a, Occupancy b, Occupancy c, Occupancy d) {
  OccupancyGrid map(3, 6, kWall);
  map[{1, 1}] = a;
  map[{1, 2}] = b;
  map[{1, 3}] = c;
  map[{1, 4}] = d;
  return map;
}

const OccupancyGrid& Truth() {
  static const OccupancyGrid truth = Row(kFree, kFree, kWall, kWall);
  return truth;
}

const OccupancyGrid& Initial() {  // cells 2 and 3 wrong
  static const OccupancyGrid initial = Row(kFree, kWall, kFree, kWall);
  return initial;
}

TEST_CASE("an untouched map has mapping accuracy 0", "[grid]") {
  const MapAccuracy accuracy = CompareMaps(Truth(), Initial(), ToBelief(Initial()));
  CHECK(accuracy.editable_cells == 4);
  CHECK(accuracy.wrong_at_first == 2);
  CHECK(accuracy.mapping == 0.0);
  CHECK(accuracy.cell == 0.5);
}

TEST_CASE("each corrected cell counts by its share of the wrong ones", "[grid]") {
  const MapAccuracy half =
      CompareMaps(Truth(), Initial(), ToBelief(Row(kFree, kFree, kFree, kWall)));
  CHECK(half.corrected == 1);
  CHECK(half.mapping == 0.5);
  CHECK(half.cell == 0.75);
  CHECK(CompareMaps(Truth(), Initial(), ToBelief(Truth())).mapping == 1.0);
}

TEST_CASE("a broken cell takes back a corrected one, and never below 0", "[grid]") {
  const MapAccuracy even =
      CompareMaps(Truth(), Initial(), ToBelief(Row(kWall, kFree, kFree, kWall)));
  CHECK(even.corrected == 1);
  CHECK(even.broken == 1);
  CHECK(even.mapping == 0.0);
  const MapAccuracy worse =
      CompareMaps(Truth(), Initial(), ToBelief(Row(kWall, kWall, kFree, kFree)));
  CHECK(worse.broken == 2);
  CHECK(worse.mapping == 0.0);
  CHECK(worse.cell == 0.0);
}

TEST_CASE("a right map that stays right has accuracy 1, one that is broken 0", "[grid]") {
  CHECK(CompareMaps(Truth(), Truth(), ToBelief(Truth())).mapping == 1.0);
  CHECK(CompareMaps(Truth(), Truth(), ToBelief(Initial())).mapping == 0.0);
}

TEST_CASE("a belief of one half and more is a wall", "[grid]") {
  BeliefGrid belief = ToBelief(Initial());
  belief[{1, 3}] = 0.5F;
  CHECK(CompareMaps(Truth(), Initial(), belief).corrected == 1);
  belief[{1, 3}] = 0.49F;
  CHECK(CompareMaps(Truth(), Initial(), belief).corrected == 0);
}

TEST_CASE("border cells and unknown truth do not count", "[grid]") {
  OccupancyGrid truth = Truth();
  truth[{1, 1}] = Occupancy::kUnknown;
  OccupancyGrid initial = Initial();
  initial[{0, 0}] = kFree;
  CHECK(CompareMaps(truth, initial, ToBelief(initial)).editable_cells == 3);
  CHECK(CompareMaps(truth, initial, ToBelief(initial)).wrong_at_first == 2);
}

TEST_CASE("an unknown cell is believed to be a wall by one half", "[grid]") {
  const BeliefGrid belief = ToBelief(Row(kFree, kWall, Occupancy::kUnknown, kFree));
  CHECK(belief[{1, 1}] == 0.0F);
  CHECK(belief[{1, 2}] == 1.0F);
  CHECK(belief[{1, 3}] == 0.5F);
}

TEST_CASE("from one half on a belief is a wall, all else is free", "[grid]") {
  BeliefGrid belief(1, 3);
  belief[{0, 0}] = 0.5F;
  belief[{0, 1}] = 0.49F;
  belief[{0, 2}] = 1.0F;
  const OccupancyGrid map = ToOccupancy(belief);
  CHECK(map[{0, 0}] == kWall);
  CHECK(map[{0, 1}] == kFree);
  CHECK(map[{0, 2}] == kWall);
}

}  // namespace
}  // namespace conav
