#include "sim/world/random_maze.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <fstream>
#include <nlohmann/json.hpp>

namespace conav::sim {
namespace {

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
    const RandomMazeOptions options{.height = line["height"],  // all others are the defaults
                                    .width = line["width"],
                                    .max_rooms = line["max_rooms"],
                                    .room_max_size = line["room_max_size"]};
    const Maze maze = GenerateMaze(options, line["seed"], line["generation"]);
    CHECK(line["entity"] == ToLines(maze.entities));
    CHECK(line["variations"] == ToLines(maze.variations));
  }
  CHECK(count >= 60);
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
  const RandomMazeOptions options{.height = 3,
                                  .width = 3,
                                  .room_min_size = 1,
                                  .room_max_size = 1,
                                  .simplify = false,
                                  .spawns_per_room = 0};
  REQUIRE(RefusalOf(options).empty());
  CHECK(ToLines(GenerateMaze(options, 1, 1).entities) ==
        std::vector<std::string>{"***", "*G*", "***"});
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
