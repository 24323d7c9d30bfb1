#include "operator/simulated/steering.h"

#include <catch2/catch.hpp>
#include <numbers>

#include "unit/operator/support/synthetic_fixture.h"

namespace conav::operators {
namespace {

constexpr double kPi = std::numbers::pi;
/// 5 x 5 cells of 2 m; cell (2,2) has the origin in its middle.
const GridGeometry geometry{5, 5, 2.0};
const SteeringParameters hands;

TEST_CASE("a key is expected to do what the parameters say", "[simulated]") {
  const ShownPose north{{0.0, 0.0}, kPi / 2};
  CHECK(Expect(hands, north, DriveAction::kForward).position.y_m == Approx(0.2));
  CHECK(Expect(hands, north, DriveAction::kBackward).position.y_m == Approx(-0.1));
  CHECK(Expect(hands, north, DriveAction::kTurnLeft).heading_rad == Approx(kPi / 2 + kPi / 16));
  CHECK(Expect(hands, north, DriveAction::kTurnRight).heading_rad == Approx(kPi / 2 - kPi / 16));
  CHECK(Expect(hands, north, DriveAction::kStop).heading_rad == north.heading_rad);
}

TEST_CASE("the key is the one that leads along the path", "[simulated]") {
  struct Row {
    const char* rule;
    double x_m;
    double heading_rad;
    std::vector<Cell> path;
    bool to_centre;
    DriveAction key;
  };
  const std::vector<Cell> east{{2, 2}, {2, 3}};
  const std::vector<Cell> north{{2, 2}, {1, 2}};
  using enum DriveAction;
  for (const Row& row : std::vector<Row>{
           {"towards the path: forward", 0.0, 0.0, east, false, kForward},
           {"else turn the short way", 0.0, 1.0, east, false, kTurnRight},
           {"else turn the short way", 0.0, -1.0, east, false, kTurnLeft},
           {"else turn the short way", 0.0, 3.0, east, false, kTurnRight},
           {"half of a key's 11.25 degrees is left alone", 0.0, 0.09, east, false, kForward},
           {"more than half is not", 0.0, 0.16, east, false, kTurnRight},
           {"at the path's end", 0.0, 0.0, {{2, 2}}, false, kStop},
           {"a corner is not turned at the edge of the cell", -0.9, 0.0, north, false, kForward},
           {"but near its middle", -0.3, 0.0, north, false, kTurnLeft},
           {"or a bit too far", 0.5, 0.0, north, false, kTurnLeft},
           {"to the middle after a bump: backward if that is behind", 0.7, 0.0, east, true,
            kBackward},
           {"forward if it is ahead", 0.7, kPi, east, true, kForward},
           {"else turn to it", 0.7, kPi / 2, east, true, kTurnLeft},
       }) {
    CAPTURE(row.rule, row.x_m, row.heading_rad);
    CHECK(ChooseKey(hands, geometry, {{row.x_m, 0.0}, row.heading_rad}, row.path, row.to_centre) ==
          row.key);
  }
}

TEST_CASE("off the middle is measured on the worse axis, in cells", "[simulated]") {
  CHECK(OffCentre(geometry, {0.2, -0.6}, {2, 2}) == Approx(0.3));
}

/// From (2,1) to the east: (2,2) is free, (2,3) a wall.
Snapshot Eastward() { return {.cell = {2, 1}, .visible = {{{2, 1}, {2, 2}}, {{2, 3}}}}; }

struct Stream : StreamMemory {
  Stream() : StreamMemory(5, 5) {}
  void LookOften(int times, const SnapshotReaderParameters& reader = FlawlessReader(),
                 const Snapshot& snapshot = Eastward()) {
    for (int i = 0; i < times; ++i) Look(reader, snapshot, random);
  }
  Random random{3};
};

TEST_CASE("a wall is believed when it was noticed twice, a free cell at once", "[simulated]") {
  Stream memory;
  memory.LookOften(1);
  CHECK(memory.IsFree({2, 2}));
  CHECK_FALSE(memory.IsWall({2, 3}));
  memory.LookOften(1);
  CHECK(memory.IsWall({2, 3}));
  CHECK(memory.Walls() == std::set<Cell>{{2, 3}});
  memory.ForgetWalls();
  CHECK(memory.Walls().empty());
}

TEST_CASE("seen cells are put over the map, whose errors are named, those outside are ignored",
          "[simulated]") {
  Stream memory;
  memory.LookOften(2);
  BeliefGrid map(5, 5, 0.0F);
  map[{2, 2}] = 1.0F;
  CHECK(memory.Over(map)[{2, 2}] == 0.0F);
  CHECK(memory.Over(map)[{2, 3}] == 1.0F);
  CHECK(memory.Errors(map, 6) == std::vector<CellEdit>{{{2, 2}, false}, {{2, 3}, true}});
  CHECK(memory.Errors(map, 1).size() == 1);
  StreamMemory small(2, 2);
  Random random(1);
  small.Look(FlawlessReader(), Eastward(), random);
  small.Bump({7, 7});
  CHECK(small.Walls().empty());
}

TEST_CASE("a mistaken wall is put right by the next looks, and what was driven through is free",
          "[simulated]") {
  Stream memory;
  memory.Bump({2, 2});
  CHECK(memory.IsWall({2, 2}));
  memory.LookOften(2);
  CHECK(memory.IsFree({2, 2}));
  memory.Bump({3, 1});
  Snapshot snapshot = Eastward();
  snapshot.path = {{3, 1}, {2, 1}};
  memory.LookOften(1, FlawlessReader(), snapshot);
  CHECK(memory.IsFree({3, 1}));
}

TEST_CASE("a picture that is not looked at teaches nothing, a near wall may be taken for one off",
          "[simulated]") {
  SnapshotReaderParameters reader = FlawlessReader();
  reader.lapse_probability = 1.0;
  Stream absent;
  absent.LookOften(1, reader);
  CHECK_FALSE(absent.IsFree({2, 2}));
  reader.lapse_probability = 0.0;
  reader.misplacement_probability = 1.0;
  Stream misled;
  misled.LookOften(20, reader);
  CHECK_FALSE(misled.IsWall({2, 3}));
  CHECK(misled.IsWall({2, 4}));
}

}  // namespace
}  // namespace conav::operators
