#include "sim/world/random_maze.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>

#include "common/grid/geometry.h"

namespace conav::sim {
namespace {

RandomMazeOptions OptionsOf(const nlohmann::json& line) {
  RandomMazeOptions options;
  options.height = line["height"];
  options.width = line["width"];
  options.max_rooms = line["max_rooms"];
  options.room_min_size = line["room_min_size"];
  options.room_max_size = line["room_max_size"];
  options.retry_count = line["retry_count"];
  options.extra_connection_probability = line["extra_connection_probability"];
  options.simplify = line["simplify"];
  options.has_doors = line["has_doors"];
  options.max_variations = line["max_variations"];
  options.spawns_per_room = line["spawns_per_room"];
  options.objects_per_room = line["objects_per_room"];
  return options;
}

std::string Join(const std::vector<std::string>& lines) {
  std::string text;
  for (const std::string& line : lines) text += line + "\n";
  return text;
}

std::set<Cell> OpenCells(const Maze& maze) {
  std::set<Cell> open;
  for (std::size_t i = 0; i < maze.entities.size(); ++i) {
    if (maze.entities.values()[i] != kMazeWall) open.insert(maze.entities.CellAt(i));
  }
  return open;
}

bool IsConnected(const Maze& maze) {
  OccupancyGrid map(maze.entities.rows(), maze.entities.columns(), Occupancy::kOccupied);
  const std::set<Cell> open = OpenCells(maze);
  for (const Cell cell : open) map[cell] = Occupancy::kFree;
  return ReachableCells(map, *open.begin()) == open;
}

std::string RefusalOf(const RandomMazeOptions& options) {
  const Result<void> result = CheckMazeOptions(options);
  return result ? "" : result.error().text;
}

TEST_CASE("mazes equal labmaze's, character for character, in both layers", "[maze]") {
  std::ifstream file(CONAV_TESTS_DIR "/unit/sim/world/labmaze_golden.jsonl");
  REQUIRE(file);
  int count = 0;
  for (std::string text; std::getline(file, text); ++count) {
    const nlohmann::json line = nlohmann::json::parse(text);
    INFO(line["tag"] << " seed " << line["seed"] << " generation " << line["generation"]);
    const Maze maze = GenerateMaze(OptionsOf(line), line["seed"], line["generation"]);
    CHECK(Join(ToLines(maze.entities)) == Join(line["entity"]));
    CHECK(Join(ToLines(maze.variations)) == Join(line["variations"]));
  }
  CHECK(count >= 60);
}

TEST_CASE("every maze is connected and walled in", "[maze]") {
  RandomMazeOptions options;
  options.width = 21;
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    const Maze maze = GenerateMaze(options, seed, 1);
    CHECK(IsConnected(maze));
    for (std::size_t i = 0; i < maze.entities.size(); ++i) {
      if (!maze.entities.OnBorder(maze.entities.CellAt(i))) continue;
      CHECK(maze.entities.values()[i] == kMazeWall);
    }
  }
}

TEST_CASE("each option does what it says: fewer dead ends, doors, more openings, more rooms",
          "[maze]") {
  const auto count = [](const RandomMazeOptions& options, auto&& counts) {
    const Maze maze = GenerateMaze(options, 5, 1);
    int number = 0;
    for (std::size_t i = 0; i < maze.entities.size(); ++i) {
      number += counts(maze, maze.entities.CellAt(i)) ? 1 : 0;
    }
    return number;
  };
  const auto is_open = [](const Maze& maze, Cell cell) { return maze.entities[cell] != kMazeWall; };
  const auto is_dead_end = [&](const Maze& maze, Cell cell) {
    return is_open(maze, cell) && std::ranges::count_if(kNeighbourOffsets, [&](Cell offset) {
                                    return is_open(maze, cell + offset);
                                  }) <= 1;
  };
  const auto is_door = [](const Maze& maze, Cell cell) {
    return maze.entities[cell] == kMazeVerticalDoor || maze.entities[cell] == kMazeHorizontalDoor;
  };
  RandomMazeOptions options;
  options.width = 31;
  RandomMazeOptions plain = options;
  plain.simplify = false;
  CHECK(count(options, is_dead_end) < count(plain, is_dead_end));
  RandomMazeOptions doors = options;
  doors.has_doors = true;
  CHECK(count(options, is_door) == 0);
  CHECK(count(doors, is_door) > 0);
  RandomMazeOptions openings = plain;
  openings.extra_connection_probability = 1.0;
  CHECK(count(openings, is_open) > count(plain, is_open));
  CHECK(GenerateMaze(options, 1, 1).rooms == 6);
  options.max_rooms = 0;  // as many as fit
  CHECK(GenerateMaze(options, 1, 1).rooms > 6);
}

TEST_CASE("the smallest maze has one cell", "[maze]") {
  RandomMazeOptions options;
  options.height = 3;
  options.width = 3;
  options.room_min_size = 1;
  options.room_max_size = 1;
  options.simplify = false;
  REQUIRE(RefusalOf(options).empty());
  options.spawns_per_room = 0;
  const Maze maze = GenerateMaze(options, 1, 1);
  CHECK(OpenCells(maze) == std::set<Cell>{{1, 1}});
  CHECK(maze.entities[{1, 1}] == kMazeObject);
}

TEST_CASE("sizes that no maze can have are refused by name and value", "[maze]") {
  using Options = RandomMazeOptions;
  const std::pair<const char*, void (*)(Options&)> rows[] = {
      {"height 12", [](Options& o) { o.height = 12; }},
      {"width 1 ", [](Options& o) { o.width = 1; }},
      {"width 1001", [](Options& o) { o.width = 1001; }},
      {"room-min 7", [](Options& o) { o.room_min_size = 7; }},
      {"room-min 0", [](Options& o) { o.room_min_size = 0; }},
      {"room-max 5", [](Options& o) { o.width = 5; }},
      {"max-rooms -1", [](Options& o) { o.max_rooms = -1; }},
      {"extra-connection-probability 1.5",
       [](Options& o) { o.extra_connection_probability = 1.5; }},
  };
  for (const auto& [begins_with, change] : rows) {
    Options options;
    change(options);
    CHECK_THAT(RefusalOf(options), Catch::StartsWith(begins_with));
  }
}

}  // namespace
}  // namespace conav::sim
