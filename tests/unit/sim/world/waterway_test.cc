#include <catch2/catch.hpp>
#include <chrono>
#include <cmath>
#include <optional>

#include "sim/world/clearance.h"
#include "sim/world/episode.h"
#include "sim/world/episode_drive.h"
#include "sim/world/world_spec.h"

namespace conav::sim {
namespace {

using namespace std::chrono_literals;

/// The waterway of a seed, its boat and its rules.
struct Voyage {
  explicit Voyage(std::uint64_t seed, double radius_m = 0.3, double top_speed_mps = 2.0) {
    WorldOptions options;
    options.preset = kWaterwayPreset;
    options.seed = seed;
    options.robot_radius_m = radius_m;
    auto made = MakeWorldSpec(options);
    REQUIRE(made);
    spec = *std::move(made);
    PhysicsWorld world;
    world.truth = spec.truth;
    world.open = true;
    world.heights = spec.heights;
    world.cell_size_m = spec.cell_size_m;
    world.robot_radius_m = radius_m;
    world.top_speed_mps = top_speed_mps;
    world.robots = {{"r1", spec.starts.front(), 0.0}};
    auto created = RobotWorld::Create(std::move(world));
    REQUIRE(created);
    physics = *std::move(created);
    EpisodeOptions rules;
    rules.goals = spec.goals;
    rules.observation_distance_cells = 50.0;
    rules.open = true;
    rules.robot_radius_m = radius_m;
    episode.emplace(*physics, std::move(rules));
  }

  RobotCommand Along(std::vector<Position> places) {
    return {.robot = "r1",
            .sequence_number = ++sequence_number,
            .lease_epoch = 1,
            .expires_at = episode->now() + 3600s,
            .kind = CommandKind::kMove,
            .path = std::move(places),
            .tolerance_m = 0.4};
  }

  /// From the boat's middle to the nearest land.
  double ClearanceM() const {
    const Position at = physics->pose(0).position;
    const Cell here = physics->geometry().PositionToCell(at);
    double nearest = 1e9;
    for (int row = -3; row <= 3; ++row) {
      for (int column = -3; column <= 3; ++column) {
        const Cell cell = here + Cell{row, column};
        if (spec.truth[cell] == Occupancy::kFree) continue;
        nearest = std::min(nearest, DistanceToCell(physics->geometry(), at, cell));
      }
    }
    return nearest;
  }

  WorldSpec spec;
  std::unique_ptr<RobotWorld> physics;
  std::optional<Episode> episode;
  std::uint64_t sequence_number = 0;
};

TEST_CASE("a boat follows the shortest way through a waterway to its goal", "[waterway][episode]") {
  Voyage voyage(1);
  const Cell start = voyage.spec.starts.front();
  const Cell goal = voyage.spec.goals.front().front();
  const std::vector<Cell> way = WayBack(StepsFrom(RoomFor(voyage.spec.truth, 1.0), goal), start);
  REQUIRE(way.size() > 100);
  std::vector<Position> places;
  for (std::size_t i = 1; i < way.size(); ++i) {
    const bool corner = i + 1 == way.size() || way[i + 1] - way[i] != way[i] - way[i - 1];
    if (corner) places.push_back(voyage.physics->geometry().CellToPosition(way[i]));
  }
  REQUIRE(voyage.episode->Accept(voyage.Along(places)));
  double nearest = 1e9;
  for (int i = 0; i < 4000 && voyage.episode->active(); ++i) {
    voyage.episode->Step();
    nearest = std::min(nearest, voyage.ClearanceM());
  }
  const RobotState state = voyage.episode->state(0);
  INFO(state.command_detail);
  CHECK(state.command_outcome == CommandOutcome::kDone);
  CHECK(state.goals_left.empty());
  CHECK(nearest > 0.3);
  CHECK(state.distance_m < 1.05 * static_cast<double>(way.size()));
  // What it has seen is true, and reaches as far as its sensor does.
  const OccupancyGrid& known = voyage.episode->map(0).cells;
  for (std::size_t i = 0; i < known.size(); ++i) {
    const Occupancy cell = known.values()[i];
    REQUIRE((cell == Occupancy::kUnknown || cell == voyage.spec.truth.values()[i]));
  }
  CHECK(std::ranges::count(known.values(), Occupancy::kFree) > 1000);
}

TEST_CASE("a boat stops in front of land from any side", "[waterway][episode]") {
  Voyage voyage(2);
  const Position start = voyage.physics->geometry().CellToPosition(voyage.spec.starts.front());
  for (int direction = 0; direction < 8; ++direction) {
    INFO("direction " << direction);
    const Position far = Ahead(start, direction * 0.7853981633974483, 10.0);
    REQUIRE(voyage.episode->Accept(voyage.Along({far})));
    double nearest = 1e9;
    for (int i = 0; i < 400 && voyage.episode->active(); ++i) {
      voyage.episode->Step();
      nearest = std::min(nearest, voyage.ClearanceM());
    }
    const RobotState state = voyage.episode->state(0);
    if (state.command_outcome == CommandOutcome::kBlocked) {
      CHECK(voyage.episode->map(0).cells[state.command_cell] == Occupancy::kOccupied);
    } else {
      CHECK(state.command_outcome == CommandOutcome::kDone);
    }
    CHECK(nearest > 0.3);
    CHECK(std::abs(voyage.physics->pose(0).speed_mps) < 0.1);
    voyage.physics->Teleport(0, start, 0.0);
  }
}

TEST_CASE("a boat without rules runs aground on the height field", "[waterway][episode]") {
  Voyage voyage(3);
  voyage.physics->Teleport(0, voyage.physics->pose(0).position, 1.5707963267948966);
  voyage.physics->Drive(0, -1.0, 0.0);
  for (int i = 0; i < 120; ++i) voyage.physics->Step();
  const Cell here = voyage.physics->cell(0);
  bool shore = false;
  for (int row = -1; row <= 1; ++row) {
    for (int column = -1; column <= 1; ++column) {
      const Cell cell = here + Cell{row, column};
      shore = shore || voyage.spec.truth[cell] == Occupancy::kFree;
    }
  }
  CHECK(shore);
}

TEST_CASE("boats keep their top speed, of any size", "[waterway][episode]") {
  for (const auto& [radius_m, speed_mps] : {std::pair(0.1, 2.0), {0.3, 1.0}, {1.0, 2.0}}) {
    INFO(radius_m << " m");
    Voyage voyage(4, radius_m, speed_mps);
    const Cell goal = voyage.spec.goals.front().front();
    const std::vector<Cell> way = WayBack(
        StepsFrom(RoomFor(voyage.spec.truth, radius_m + 0.5), goal), voyage.spec.starts.front());
    REQUIRE(way.size() > 100);
    std::vector<Position> places;
    for (const Cell cell : way) places.push_back(voyage.physics->geometry().CellToPosition(cell));
    places.resize(20);
    REQUIRE(voyage.episode->Accept(voyage.Along(places)));
    double fastest = 0.0;
    for (int i = 0; i < 1000 && voyage.episode->active(); ++i) {
      voyage.episode->Step();
      fastest = std::max(fastest, voyage.physics->pose(0).speed_mps);
    }
    INFO(voyage.episode->state(0).command_detail);
    CHECK(voyage.episode->state(0).command_outcome == CommandOutcome::kDone);
    CHECK(fastest <= 1.02 * speed_mps);
    CHECK(fastest > 0.5 * speed_mps);
  }
}

TEST_CASE("steps, views and observations of a waterway take time", "[.][benchmark][waterway]") {
  Voyage voyage(1);
  const auto milliseconds = [](auto&& work, int times) {
    const auto begin = std::chrono::steady_clock::now();
    for (int i = 0; i < times; ++i) work();
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin)
               .count() /
           times;
  };
  voyage.physics->Drive(0, -1.0, 0.3);
  WARN("step " << milliseconds([&] { voyage.physics->Step(); }, 200) << " ms");
  voyage.physics->Drive(0, -1.0, 0.0);
  WARN("step aground " << milliseconds([&] { voyage.physics->Step(); }, 400) << " ms");
  const Cell start = voyage.spec.starts.front();
  WARN("range 50 " << milliseconds([&] { CastRange(voyage.spec.truth, start, 50.0); }, 200)
                   << " ms");
  const OccupancyGrid lake(1000, 1000, Occupancy::kFree);
  WARN("range 50 in the open " << milliseconds(
                                      [&] {
                                        CastRange(lake, {500, 500}, 50.0);
                                      },
                                      200)
                               << " ms");
}

}  // namespace
}  // namespace conav::sim
