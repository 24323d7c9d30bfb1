#include <catch2/catch.hpp>
#include <cmath>
#include <optional>

#include "sim/world/episode.h"

namespace conav::sim {
namespace {

using namespace std::chrono_literals;

/// 16 x 24 cells of 1 m, free but for the border and a wall of three cells at (7,12); robots look
/// east.
struct Lake {
  explicit Lake(const std::vector<Cell>& starts = {{7, 4}}, std::vector<Cell> goals = {{3, 18}},
                double range_cells = 5.0) {
    PhysicsWorld world;
    world.cell_size_m = 1.0;
    world.truth = OccupancyGrid(16, 24, Occupancy::kFree);
    for (std::size_t i = 0; i < world.truth.size(); ++i) {
      const Cell cell = world.truth.CellAt(i);
      const bool island = cell.column == 12 && cell.row >= 6 && cell.row <= 8;
      if (world.truth.OnBorder(cell) || island) world.truth[cell] = Occupancy::kOccupied;
    }
    for (std::size_t i = 0; i < starts.size(); ++i) {
      world.robots.push_back({fmt::format("r{}", i + 1), starts[i], 0.0});
    }
    auto created = RobotWorld::Create(std::move(world));
    REQUIRE(created);
    physics = *std::move(created);
    EpisodeOptions options;
    options.goals.assign(starts.size(), goals);
    options.observation_distance_cells = range_cells;
    options.open = true;
    episode.emplace(*physics, std::move(options));
  }

  RobotCommand Along(std::vector<Position> places, const std::string& robot = "r1") {
    return {.robot = robot,
            .sequence_number = ++sequence_number,
            .lease_epoch = 1,
            .expires_at = episode->now() + 60s,
            .kind = CommandKind::kMove,
            .path = std::move(places),
            .tolerance_m = 0.5};
  }
  Position At(Cell cell) const { return physics->geometry().CellToPosition(cell); }
  CommandOutcome Do(const RobotCommand& command, int robot = 0) {
    REQUIRE(episode->Accept(command));
    for (int i = 0; i < 300 && episode->active(); ++i) episode->Step();
    return episode->state(robot).command_outcome;
  }
  double DistanceTo(Position place, int robot = 0) const {
    const Position at = physics->pose(robot).position;
    return std::hypot(at.x_m - place.x_m, at.y_m - place.y_m);
  }

  std::unique_ptr<RobotWorld> physics;
  std::optional<Episode> episode;
  std::uint64_t sequence_number = 0;
};

TEST_CASE("in open terrain a robot drives straight to any place and along several",
          "[episode][open]") {
  Lake lake;
  const Position place{-3.3, 4.4};
  CHECK(lake.Do(lake.Along({place})) == CommandOutcome::kDone);
  CHECK(lake.DistanceTo(place) < kSettledM);
  RobotState state = lake.episode->state(0);
  CHECK(state.cell == lake.physics->geometry().PositionToCell(place));
  CHECK(state.path.front() == Cell{7, 4});
  CHECK(state.path.back() == state.cell);
  CHECK(state.cell_moves == 1);
  CHECK(lake.Do(lake.Along({{-6.0, 5.0}, {-6.0, 0.5}, {-8.0, 0.5}})) == CommandOutcome::kDone);
  state = lake.episode->state(0);
  CHECK(state.cell_moves == 4);
  CHECK(state.distance_m == Approx(5.4 + 2.77 + 4.5 + 2.0).margin(0.8));
}

TEST_CASE("in open terrain a robot stops in front of an obstacle and has seen it",
          "[episode][open]") {
  Lake lake({{7, 4}}, {{3, 18}}, 1.0);  // it sees no farther than it brakes
  CHECK(lake.episode->map(0).cells[{7, 12}] == Occupancy::kUnknown);
  CHECK(lake.Do(lake.Along({lake.At({7, 20})})) == CommandOutcome::kBlocked);
  const RobotState state = lake.episode->state(0);
  CHECK(state.command_cell == Cell{7, 12});
  CHECK(lake.physics->pose(0).position.x_m < lake.At({7, 12}).x_m - 0.5 - 0.2);
  CHECK(std::abs(lake.physics->pose(0).speed_mps) < 0.1);
  CHECK(lake.episode->map(0).cells[{7, 12}] == Occupancy::kOccupied);
  CHECK(lake.episode->map(0).stamp == state.map_stamp);
  CHECK(lake.Do(lake.Along({lake.At({3, 9}), lake.At({3, 15})})) == CommandOutcome::kDone);
}

TEST_CASE("in open terrain a goal is reached nearby, on the way as well", "[episode][open]") {
  Lake lake({{7, 4}}, {{6, 8}});
  CHECK(lake.Do(lake.Along({lake.At({7, 10})})) == CommandOutcome::kDone);
  CHECK(lake.episode->state(0).goals_left.empty());
  CHECK(lake.episode->goal_tolerance_m() == kOpenGoalM);
}

TEST_CASE("in open terrain a robot stops in front of another one", "[episode][open]") {
  Lake lake({{7, 4}, {7, 9}});
  CHECK(lake.Do(lake.Along({lake.At({7, 11})})) == CommandOutcome::kOccupied);
  CHECK(lake.DistanceTo(lake.physics->pose(1).position) > 0.5);
}

TEST_CASE("in open terrain expiry and stop make a robot brake where it is", "[episode][open]") {
  Lake lake;
  RobotCommand command = lake.Along({lake.At({7, 10})});
  command.expires_at = lake.episode->now() + 1500ms;
  CHECK(lake.Do(command) == CommandOutcome::kExpired);
  CHECK(std::abs(lake.physics->pose(0).speed_mps) < 0.1);
  REQUIRE(lake.episode->Accept(lake.Along({lake.At({7, 10})})));
  for (int i = 0; i < 6; ++i) lake.episode->Step();
  lake.episode->Accept(StopOrder{{}, "w1", "r1", 1, true, "anna", ""});
  while (lake.episode->active()) lake.episode->Step();
  CHECK(lake.episode->state(0).command_outcome == CommandOutcome::kStopped);
  CHECK(lake.episode->state(0).cell ==
        lake.physics->geometry().PositionToCell(lake.physics->pose(0).position));
}

TEST_CASE("in open terrain a place off the map is refused", "[episode][open]") {
  Lake lake;
  CHECK(lake.Do(lake.Along({{0.0, 0.0}, {40.0, 0.0}})) == CommandOutcome::kRefused);
  CHECK_THAT(lake.episode->state(0).command_detail, Catch::Contains("40"));
}

}  // namespace
}  // namespace conav::sim
