#include "sim/world/episode.h"

#include <catch2/catch.hpp>
#include <optional>

namespace conav::sim {
namespace {

using namespace std::chrono_literals;

/// A corridor of five cells; r1 starts in its west end.
struct Corridor {
  explicit Corridor(std::vector<Cell> starts = {{1, 1}},
                    std::vector<std::vector<Cell>> goals = {{{1, 3}}}, bool shared = false) {
    PhysicsWorld world;
    world.truth = OccupancyGrid(3, 7, Occupancy::kOccupied);
    for (int column = 1; column < 6; ++column) world.truth[{1, column}] = Occupancy::kFree;
    for (std::size_t i = 0; i < starts.size(); ++i) {
      world.robots.push_back({fmt::format("r{}", i + 1), starts[i], 0.0});
    }
    auto created = RobotWorld::Create(std::move(world));
    REQUIRE(created);
    physics = *std::move(created);
    episode.emplace(*physics, EpisodeOptions{"w1", std::move(goals), shared, 2.0});
  }

  /// Gives the command and goes on until no robot moves.
  void Move(Cell target, const std::string& robot = "r1") {
    REQUIRE(episode->Accept(Command(CommandKind::kMove, target, robot)));
    Settle();
  }

  RobotCommand Command(CommandKind kind, Cell target, const std::string& robot = "r1") {
    return {.robot = robot,
            .sequence_number = ++sequence_number,
            .lease_epoch = 1,
            .expires_at = episode->now() + 20s,
            .kind = kind,
            .path = {physics->geometry().CellToPosition(target)},
            .tolerance_m = 0.1};
  }

  /// What comes of a command at once.
  CommandOutcome Begin(const RobotCommand& command, int robot = 0) {
    REQUIRE(episode->Accept(command));
    return Outcome(robot);
  }

  CommandOutcome Outcome(int robot = 0) const { return episode->state(robot).command_outcome; }

  /// Steps until no robot moves, at most 100 control steps.
  void Settle() {
    for (int i = 0; i < 100 && episode->active() && episode->snapshots_due().empty(); ++i)
      episode->Step();
  }

  std::unique_ptr<RobotWorld> physics;
  std::optional<Episode> episode;
  std::uint64_t sequence_number = 0;
};

TEST_CASE("a move ends in the next cell and counts once", "[episode]") {
  Corridor world;
  REQUIRE(world.episode->Accept(world.Command(CommandKind::kMove, {1, 2})));
  CHECK(world.Outcome() == CommandOutcome::kRunning);
  world.Settle();
  const RobotState state = world.episode->state(0);
  CHECK(state.command_outcome == CommandOutcome::kDone);
  CHECK(state.cell == Cell{1, 2});
  CHECK(state.cell_moves == 1);
  CHECK(state.low_level_steps > 2);
  CHECK(state.low_level_steps < 20);
  CHECK(state.path == std::vector<Cell>{{1, 1}, {1, 2}});
}

TEST_CASE("a wall blocks without taking time and is on the robot's map afterwards", "[episode]") {
  Corridor world;
  const SimTime map_stamp = world.episode->map(0).stamp;
  CHECK(world.Begin(world.Command(CommandKind::kMove, {0, 1})) == CommandOutcome::kBlocked);
  CHECK_FALSE(world.episode->active());
  CHECK(world.episode->map(0).cells[{0, 1}] == Occupancy::kOccupied);
  CHECK(world.episode->map(0).stamp > map_stamp);
  CHECK(world.episode->state(0).map_stamp == world.episode->map(0).stamp);
}

TEST_CASE("a door closes after so many moves, when nobody is in it or on the way there",
          "[episode]") {
  Corridor world({{1, 1}, {1, 5}}, {{{1, 3}}, {{1, 5}}});
  PhysicsWorld plan = world.physics->world();
  plan.doors = {{1, 3}, {1, 4}};
  auto physics = RobotWorld::Create(std::move(plan)).value();
  world.episode.emplace(
      *physics, EpisodeOptions{.goals = {{{1, 3}}, {}}, .doors = {{{1, 3}, 2}, {{1, 4}, 1}}});
  const auto truth = [&](Cell cell) { return physics->world().truth[cell]; };
  world.Move({1, 2});
  CHECK(world.episode->doors_closed() == 1);
  CHECK(truth({1, 4}) == Occupancy::kOccupied);
  CHECK(world.episode->map(0).cells[{1, 4}] == Occupancy::kOccupied);  // two cells away
  world.Move({1, 3});
  CHECK(truth({1, 3}) == Occupancy::kFree);  // the second move, but the robot is in it
  CHECK(world.episode->state(0).goals_reached == std::vector<Cell>{{1, 3}});
  CHECK(world.Begin(world.Command(CommandKind::kMove, {1, 4})) == CommandOutcome::kBlocked);
  world.Move({1, 2});
  CHECK(world.episode->doors_closed() == 2);
  CHECK(truth({1, 3}) == Occupancy::kOccupied);
  CHECK(world.episode->map(0).cells[{1, 3}] == Occupancy::kOccupied);
}

TEST_CASE("a cell that is no neighbour and an unknown robot are refused by name", "[episode]") {
  Corridor world;
  CHECK(world.Begin(world.Command(CommandKind::kMove, {1, 4})) == CommandOutcome::kRefused);
  CHECK_THAT(world.episode->state(0).command_detail, Catch::Contains("(1,4) is not a neighbour"));
  const auto unknown = world.episode->Accept(world.Command(CommandKind::kStop, {}, "r9"));
  REQUIRE_FALSE(unknown);
  CHECK_THAT(unknown.error().text, Catch::StartsWith("robot = 'r9'"));
}

TEST_CASE(
    "a robot drives along several places, ends with the heading asked for, and stops where "
    "the way is closed",
    "[episode]") {
  Corridor world({{1, 1}, {1, 5}}, {{{1, 3}}, {}});
  const auto along = [&](const std::vector<Cell>& cells) {
    RobotCommand command = world.Command(CommandKind::kMove, cells.front());
    for (const Cell cell : cells) {
      if (cell != cells.front()) {
        command.path.push_back(world.physics->geometry().CellToPosition(cell));
      }
    }
    return command;
  };
  RobotCommand command = along({{1, 2}, {1, 3}});
  command.arrival_heading_rad = 1.5707963;
  REQUIRE(world.episode->Accept(command));
  world.Settle();
  RobotState state = world.episode->state(0);
  CHECK(state.command_outcome == CommandOutcome::kDone);
  CHECK(state.path == std::vector<Cell>{{1, 1}, {1, 2}, {1, 3}});
  CHECK(state.heading_rad == Approx(1.5707963).margin(0.02));
  CHECK(state.distance_m == Approx(4.0).margin(0.1));
  CHECK(state.goals_left.empty());
  REQUIRE(world.episode->Accept(along({{1, 4}, {1, 5}})));
  world.Settle();
  state = world.episode->state(0);
  CHECK(state.command_outcome == CommandOutcome::kOccupied);
  CHECK(state.cell == Cell{1, 4});
  CHECK(state.command_cell == Cell{1, 5});
  CHECK(world.Begin(along({{1, 3}, {1, 1}})) == CommandOutcome::kRefused);  // no neighbours
  CHECK(world.episode->state(0).cell == Cell{1, 4});
}

TEST_CASE(
    "a place that is no middle of a cell, or a tolerance that the robot cannot keep, is refused",
    "[episode]") {
  Corridor world;
  RobotCommand exact = world.Command(CommandKind::kMove, {1, 2});
  exact.tolerance_m = 0.01;
  CHECK(world.Begin(exact) == CommandOutcome::kRefused);
  CHECK_THAT(world.episode->state(0).command_detail, Catch::Contains("tolerance"));
  RobotCommand aside = world.Command(CommandKind::kMove, {1, 2});
  aside.path[0].y_m += 0.3;
  CHECK(world.Begin(aside) == CommandOutcome::kRefused);
  aside = world.Command(CommandKind::kMove, {1, 2});
  aside.path[0].y_m += 0.05;
  CHECK(world.Begin(aside) == CommandOutcome::kRunning);
}

TEST_CASE("a stopped robot brakes, and stands whatever the epoch of a command, until it is resumed",
          "[episode][stop]") {
  Corridor world;
  REQUIRE(world.episode->Accept(world.Command(CommandKind::kMove, {1, 2})));
  for (int i = 0; i < 3; ++i) world.episode->Step();
  world.episode->Accept(StopOrder{{}, "w1", "r1", 1, true, "anna", ""});
  CHECK(world.episode->state(0).stopped);
  CHECK(world.Outcome() == CommandOutcome::kStopped);
  world.Settle();
  CHECK(std::abs(world.physics->pose(0).speed_mps) < 0.2);
  RobotCommand command = world.Command(CommandKind::kMove, {1, 2});
  command.lease_epoch = 77;
  CHECK(world.Begin(command) == CommandOutcome::kStopped);
  CHECK_FALSE(world.episode->active());
  world.episode->Accept(StopOrder{{}, "w1", "r1", 2, false, "anna", ""});
  CHECK_FALSE(world.episode->state(0).stopped);
  CHECK_FALSE(world.episode->active());  // silence never means go on
  ++command.sequence_number;
  command.path = {
      world.physics->geometry().CellToPosition(world.episode->state(0).cell + Cell{0, 1})};
  CHECK(world.Begin(command) == CommandOutcome::kRunning);
}

TEST_CASE("a robot that stopped on its way drives on from there, or back to turn off",
          "[episode]") {
  const bool goes_on = GENERATE(true, false);
  Corridor world({{1, 2}, {1, 5}}, {{{1, 1}}, {}});
  world.Move({1, 3});  // turned east
  REQUIRE(world.episode->Accept(world.Command(CommandKind::kMove, {1, 4})));
  for (int i = 0; i < 2; ++i) world.episode->Step();
  REQUIRE(world.episode->Accept(world.Command(CommandKind::kStop, {})));
  world.Settle();
  RobotState state = world.episode->state(0);
  const Position middle = world.physics->geometry().CellToPosition(state.cell);
  REQUIRE(Distance(state.position, middle) > 0.3);
  const double driven_m = state.distance_m;
  world.Move(state.cell + (goes_on ? Cell{0, 1} : Cell{0, -1}));
  CHECK(world.Outcome() == CommandOutcome::kDone);
  const double way_m = world.episode->state(0).distance_m - driven_m;
  const double off_m = Distance(state.position, middle);
  CHECK(way_m == Approx(2.0 + (goes_on ? -off_m : off_m)).margin(0.1));
}

TEST_CASE("a repeated command changes nothing, an older one or one of an older lease is refused",
          "[episode]") {
  Corridor world;
  const RobotCommand first = world.Command(CommandKind::kMove, {1, 2});
  REQUIRE(world.episode->Accept(first));
  world.Settle();
  REQUIRE(world.episode->Accept(first));
  CHECK_FALSE(world.episode->active());
  RobotCommand second = world.Command(CommandKind::kMove, {1, 3});
  second.lease_epoch = 5;
  CHECK(world.Begin(second) == CommandOutcome::kRunning);
  RobotCommand old = first;
  old.lease_epoch = 5;
  CHECK(world.episode->Accept(old).error().code == ErrorCode::kRefused);
  old.lease_epoch = 4;
  old.sequence_number = 99;
  CHECK(world.episode->Accept(old).error().code == ErrorCode::kRefused);
  CHECK(world.episode->state(0).lease_epoch == 5);
  CHECK(world.Outcome() == CommandOutcome::kRunning);
}

TEST_CASE(
    "an expired command is void, and one that expires on the way stops the robot, which can go "
    "on",
    "[episode]") {
  Corridor world;
  RobotCommand late = world.Command(CommandKind::kMove, {1, 2});
  late.expires_at = world.episode->now();
  CHECK(world.Begin(late) == CommandOutcome::kExpired);
  CHECK_FALSE(world.episode->active());
  RobotCommand command = world.Command(CommandKind::kMove, {1, 2});
  command.expires_at = world.episode->now() + 500ms;
  REQUIRE(world.episode->Accept(command));
  world.Settle();
  CHECK(world.Outcome() == CommandOutcome::kExpired);
  CHECK_FALSE(world.episode->active());
  CHECK(std::abs(world.physics->pose(0).speed_mps) < 0.2);
  const Cell from = world.episode->state(0).cell;
  world.Move(from + Cell{0, 1});
  CHECK(world.Outcome() == CommandOutcome::kDone);
}

TEST_CASE("a goal is reached once and is gone from the list", "[episode]") {
  Corridor world;
  for (const Cell cell : {Cell{1, 2}, Cell{1, 3}, Cell{1, 2}, Cell{1, 3}}) world.Move(cell);
  CHECK(world.episode->state(0).goals_left.empty());
  CHECK(world.episode->state(0).goals_reached == std::vector<Cell>{{1, 3}});
  CHECK(world.episode->state(0).goals_total == 1);
}

TEST_CASE("a shared goal belongs to the first robot that reaches it", "[episode]") {
  Corridor world({{1, 1}, {1, 5}}, {{{1, 2}, {1, 4}}, {{1, 2}, {1, 4}}}, true);
  world.Move({1, 2});
  CHECK(world.episode->state(0).goals_reached.size() == 1);
  CHECK(world.episode->state(1).goals_reached.empty());
  CHECK(world.episode->state(1).goals_left == std::vector<Cell>{{1, 4}});
}

TEST_CASE("two robots never get one cell, neither where one stands nor where it drives",
          "[episode]") {
  Corridor world({{1, 1}, {1, 3}}, {{{1, 5}}, {{1, 5}}});
  using enum CommandOutcome;
  CHECK(world.Begin(world.Command(CommandKind::kMove, {1, 2}, "r1")) == kRunning);
  CHECK(world.Begin(world.Command(CommandKind::kMove, {1, 2}, "r2"), 1) == kOccupied);
  world.Settle();
  CHECK(world.Begin(world.Command(CommandKind::kMove, {1, 3}, "r1")) == kOccupied);
  CHECK(world.episode->map(0).cells[{1, 3}] == Occupancy::kFree);
  world.Move({1, 4}, "r2");  // it blocks the cell only while it stands there
  world.Move({1, 3}, "r1");
  CHECK(world.Outcome(0) == kDone);
  CHECK(world.episode->state(0).cell == Cell{1, 3});
}

TEST_CASE("a view turns the robot, waits for its picture and starts the path again", "[episode]") {
  Corridor world;
  world.Move({1, 2});
  RobotCommand command = world.Command(CommandKind::kTransmitView, {});
  command.heading_rad = 1.5707963;
  REQUIRE(world.episode->Accept(command));
  world.Settle();
  REQUIRE(world.episode->snapshots_due() == std::vector<int>{0});
  const Snapshot snapshot = world.episode->CompleteView(0, 1234);
  CHECK(snapshot.sequence_number == 1);
  CHECK(snapshot.path == std::vector<Cell>{{1, 1}, {1, 2}});
  const RobotState state = world.episode->state(0);
  CHECK(state.command_outcome == CommandOutcome::kDone);
  CHECK(state.images == 1);
  CHECK(state.image_bytes == 1234);
  CHECK(state.snapshots == 1);
  CHECK(state.path == std::vector<Cell>{{1, 2}});
  CHECK(world.episode->snapshots_due().empty());
}

TEST_CASE("the robot's map grows with what it sees, up to the observation distance", "[episode]") {
  Corridor world;
  CHECK(world.episode->map(0).cells[{1, 3}] == Occupancy::kFree);
  CHECK(world.episode->map(0).cells[{1, 4}] == Occupancy::kUnknown);
  world.Move({1, 2});
  CHECK(world.episode->map(0).cells[{1, 4}] == Occupancy::kFree);
}

}  // namespace
}  // namespace conav::sim
