#include "sim/world/episode_drive.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <optional>

#include "sim/world/episode.h"

namespace conav::sim {
namespace {

using namespace std::chrono_literals;

constexpr double kDegree = 0.017453292519943295;

/// 7 x 7 cells of 2 m, free but for the border; robots look east.
class Hall {
 public:
  explicit Hall(const std::vector<Cell>& starts = {{3, 1}},
                const std::vector<Cell>& goals = {{3, 3}}) {
    PhysicsWorld world;
    world.truth = OccupancyGrid(7, 7, Occupancy::kFree);
    for (std::size_t i = 0; i < world.truth.size(); ++i) {
      const Cell cell = world.truth.CellAt(i);
      if (world.truth.OnBorder(cell)) world.truth[cell] = Occupancy::kOccupied;
    }
    for (std::size_t i = 0; i < starts.size(); ++i) {
      world.robots.push_back({fmt::format("r{}", i + 1), starts[i], 0.0});
    }
    auto created = RobotWorld::Create(std::move(world));
    REQUIRE(created);
    physics = *std::move(created);
    EpisodeOptions options;
    options.goals.assign(starts.size(), goals);
    episode.emplace(*physics, std::move(options));
  }

  RobotCommand Key(DriveAction action, const std::string& robot = "r1") {
    ++sequence_number;
    return {.robot = robot,
            .sequence_number = sequence_number,
            .lease_epoch = 1,
            .expires_at = episode->now() + 1s,
            .kind = CommandKind::kDrive,
            .drive = action,
            .drive_order = sequence_number};
  }

  /// What comes at once of a move into a neighbouring cell.
  CommandOutcome Move(Cell target, int robot) {
    RobotCommand move = Key(DriveAction::kStop, fmt::format("r{}", robot + 1));
    move.kind = CommandKind::kMove;
    move.path = {physics->geometry().CellToPosition(target)};
    move.tolerance_m = 0.1;
    move.expires_at = episode->now() + 30s;
    REQUIRE(episode->Accept(move));
    return episode->state(robot).command_outcome;
  }

  /// What comes of an action that comes too late.
  CommandOutcome PressTooLate() {
    RobotCommand late = Key(DriveAction::kForward);
    late.expires_at = episode->now();
    REQUIRE(episode->Accept(late));
    CHECK_FALSE(episode->active());
    return episode->state(0).command_outcome;
  }

  /// One action, and the one step that it takes.
  CommandOutcome Press(DriveAction action, int times = 1, int robot = 0) {
    for (int i = 0; i < times; ++i) {
      REQUIRE(episode->Accept(Key(action, fmt::format("r{}", robot + 1))));
      const SimTime before = episode->now();
      while (episode->active()) episode->Step();
      CHECK(episode->now() == before + 250ms);
    }
    return episode->state(robot).command_outcome;
  }

  double Degrees() const { return physics->pose(0).heading_rad / kDegree; }

  std::unique_ptr<RobotWorld> physics;
  std::optional<Episode> episode;
  std::uint64_t sequence_number = 0;
};

TEST_CASE("forward, held, goes 0.2 m a step, backward 0.1 m, a turn 11.25 degrees", "[drive]") {
  Hall hall({{3, 2}});
  CHECK(hall.Press(DriveAction::kForward) == CommandOutcome::kDone);
  CHECK(hall.episode->state(0).low_level_steps == 1);
  CHECK(hall.episode->state(0).drive_order == 1);
  hall.Press(DriveAction::kForward);
  const double from = hall.physics->pose(0).position.x_m;
  hall.Press(DriveAction::kForward, 4);
  CHECK(hall.physics->pose(0).position.x_m - from == Approx(0.8).margin(0.05));
  hall.Press(DriveAction::kStop, 2);
  const double back_from = hall.physics->pose(0).position.x_m;
  hall.Press(DriveAction::kBackward, 5);
  CHECK(hall.physics->pose(0).position.x_m - back_from == Approx(-0.46).margin(0.06));
  Hall turned;
  turned.Press(DriveAction::kTurnLeft, 8);
  CHECK(turned.Degrees() == Approx(88.0).margin(4.0));
  turned.Press(DriveAction::kTurnRight, 8);
  CHECK(turned.Degrees() == Approx(0.0).margin(6.0));
  const Position start = turned.physics->geometry().CellToPosition({3, 1});
  CHECK(turned.episode->state(0).position.x_m == Approx(start.x_m).margin(0.02));
}

TEST_CASE("a robot whose driver is silent brakes when time goes on", "[drive]") {
  Hall hall;
  hall.Press(DriveAction::kForward, 4);
  CHECK(hall.physics->pose(0).speed_mps == Approx(0.8).margin(0.05));
  const double from = hall.physics->pose(0).position.x_m;
  for (int i = 0; i < 4; ++i) hall.episode->Step();
  CHECK(std::abs(hall.physics->pose(0).speed_mps) < 0.05);
  CHECK(hall.physics->pose(0).position.x_m - from < 0.25);
  const std::uint64_t steps = hall.episode->state(0).low_level_steps;
  CHECK(steps > 4);  // braking counts
  CHECK(steps <= 6);
  hall.episode->Step();
  CHECK(hall.episode->state(0).low_level_steps == steps);
}

TEST_CASE("cells, path and goals follow the axis while driving on", "[drive]") {
  Hall hall;
  hall.Press(DriveAction::kForward, 18);
  const RobotState state = hall.episode->state(0);
  CHECK(state.cell == Cell{3, 3});
  CHECK(state.cell_moves == 2);
  CHECK(state.path == std::vector<Cell>{{3, 1}, {3, 2}, {3, 3}});
  CHECK(state.goals_reached == std::vector<Cell>{{3, 3}});
  CHECK(hall.episode->map(0).cells[{3, 5}] == Occupancy::kFree);
}

TEST_CASE("a diagonal way enters cells one by one", "[drive]") {
  Hall hall({{3, 1}}, {{1, 5}});
  hall.Press(DriveAction::kTurnLeft, 4);
  hall.Press(DriveAction::kForward, 24);
  const RobotState state = hall.episode->state(0);
  REQUIRE(state.path.size() > 3);
  for (std::size_t i = 1; i < state.path.size(); ++i) {
    CHECK(AreNeighbours(state.path[i - 1], state.path[i]));
  }
  CHECK(state.cell == hall.physics->cell(0));
  CHECK(state.cell_moves + 1 == state.path.size());
}

TEST_CASE("a wall ends forward before it is touched, is named, and lets go backward", "[drive]") {
  Hall hall({{3, 5}});
  CommandOutcome outcome = CommandOutcome::kDone;
  for (int i = 0; i < 10 && outcome == CommandOutcome::kDone; ++i) {
    outcome = hall.Press(DriveAction::kForward);
  }
  CHECK(outcome == CommandOutcome::kBlocked);
  CHECK(hall.episode->state(0).command_cell == Cell{3, 6});
  CHECK(hall.episode->map(0).cells[{3, 6}] == Occupancy::kOccupied);
  hall.Press(DriveAction::kForward, 5);
  const double to_wall = 5.0 - hall.episode->state(0).position.x_m;
  CHECK(to_wall > 0.2);
  CHECK(to_wall < 0.8);
  CHECK(hall.Press(DriveAction::kTurnLeft) == CommandOutcome::kDone);
  CHECK(hall.Press(DriveAction::kTurnRight) == CommandOutcome::kDone);
  CHECK(hall.Press(DriveAction::kBackward) == CommandOutcome::kDone);
}

TEST_CASE("a robot is never driven into a cell that another one holds", "[drive]") {
  Hall hall({{3, 1}, {3, 3}}, {});
  CommandOutcome outcome = CommandOutcome::kDone;
  for (int i = 0; i < 30 && outcome == CommandOutcome::kDone; ++i) {
    outcome = hall.Press(DriveAction::kForward);
  }
  CHECK(outcome == CommandOutcome::kOccupied);
  CHECK(hall.episode->state(0).command_cell == Cell{3, 3});
  hall.Press(DriveAction::kForward, 5);
  CHECK(hall.episode->state(0).cell == Cell{3, 2});
  // The other one is refused the cell that the first one stands in.
  CHECK(hall.episode->state(1).cell == Cell{3, 3});
  CHECK(hall.Move({3, 2}, 1) == CommandOutcome::kOccupied);
}

TEST_CASE("a cell that a driven robot overlaps is held until it has left", "[drive]") {
  Hall hall({{3, 1}, {2, 2}}, {});
  hall.Press(DriveAction::kForward, 5);  // near the edge to (3,2)
  CHECK(hall.Move({3, 2}, 1) == CommandOutcome::kOccupied);
  hall.Press(DriveAction::kBackward, 8);
  CHECK(hall.Move({3, 2}, 1) == CommandOutcome::kRunning);
}

TEST_CASE(
    "an action that comes too late is void, also while the robot rolls, and of a burst one is "
    "carried out",
    "[drive]") {
  Hall hall;
  CHECK(hall.PressTooLate() == CommandOutcome::kExpired);
  for (int i = 0; i < 8; ++i) REQUIRE(hall.episode->Accept(hall.Key(DriveAction::kForward)));
  while (hall.episode->active()) hall.episode->Step();
  CHECK(hall.episode->state(0).low_level_steps == 1);
  CHECK(hall.episode->state(0).drive_order == 9);
  hall.Press(DriveAction::kForward, 2);
  CHECK(hall.PressTooLate() == CommandOutcome::kExpired);
  CHECK(hall.Press(DriveAction::kForward) == CommandOutcome::kDone);
  CHECK(hall.episode->state(0).low_level_steps == 4);
}

TEST_CASE("a move primitive goes on from wherever a robot was driven to", "[drive]") {
  Hall hall;
  hall.Press(DriveAction::kTurnLeft, 2);
  hall.Press(DriveAction::kForward, 3);
  const Cell here = hall.episode->state(0).cell;
  hall.Move(here + Cell{0, 1}, 0);
  while (hall.episode->active()) hall.episode->Step();
  CHECK(hall.episode->state(0).command_outcome == CommandOutcome::kDone);
  CHECK(hall.episode->state(0).cell == here + Cell{0, 1});
}

/// 5 x 5 cells of 2 m; cell (2,2) has the origin in its middle.
const GridGeometry geometry{5, 5, 2.0};

TEST_CASE(
    "a body touches the cells that it overlaps and no other, and a way sweeps those between its "
    "ends, nearest first",
    "[episode]") {
  CHECK(CellsSwept(geometry, {0.0, 0.0}, {0.0, 0.0}) == std::vector<Cell>{{2, 2}});
  CHECK(CellsSwept(geometry, {0.9, 0.0}, {0.9, 0.0}) == std::vector<Cell>{{2, 2}, {2, 3}});
  CHECK(CellsSwept(geometry, {0.9, 0.9}, {0.9, 0.9}).size() == 4);
  // 0.2 m from both edges, but 0.28 m from the corner.
  CHECK(CellsSwept(geometry, {0.8, 0.8}, {0.8, 0.8}) == std::vector<Cell>{{1, 2}, {2, 2}, {2, 3}});
  CHECK(CellsSwept(geometry, {0.0, 0.0}, {3.0, 0.0}) == std::vector<Cell>{{2, 2}, {2, 3}, {2, 4}});
}

TEST_CASE("the axis enters cells one after the other, also diagonally", "[episode]") {
  CHECK(CellsEntered(geometry, {0.0, 0.0}, {0.5, 0.5}).empty());
  CHECK(CellsEntered(geometry, {0.0, 0.0}, {1.5, 0.0}) == std::vector<Cell>{{2, 3}});
  // East edge first, then the northern one; and the other way round.
  CHECK(CellsEntered(geometry, {0.95, 0.8}, {1.15, 1.1}) == std::vector<Cell>{{2, 3}, {1, 3}});
  CHECK(CellsEntered(geometry, {0.8, 0.95}, {1.1, 1.15}) == std::vector<Cell>{{1, 2}, {1, 3}});
  CHECK(CellsEntered(geometry, {-0.9, -0.9}, {-1.2, -1.2}) == std::vector<Cell>{{2, 1}, {3, 1}});
}

}  // namespace
}  // namespace conav::sim
