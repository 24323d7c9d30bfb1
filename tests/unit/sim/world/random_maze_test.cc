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
  const auto count = [](const RandomMazeOptions& options, char symbol) {
    return std::ranges::count(GenerateMaze(options, 5, 1).entities.values(), symbol);
  };
  RandomMazeOptions options{.width = 31};
  CHECK(count(options, kMazeVerticalDoor) + count(options, kMazeHorizontalDoor) == 0);
  RandomMazeOptions doors = options;
  doors.has_doors = true;
  CHECK(count(doors, kMazeVerticalDoor) > 0);
  CHECK(count(doors, kMazeHorizontalDoor) > 0);
  RandomMazeOptions plain = options;
  plain.simplify = false;
  CHECK(count(plain, kMazeWall) < count(options, kMazeWall));
  RandomMazeOptions openings = plain;
  openings.extra_connection_probability = 1.0;
  CHECK(count(openings, kMazeWall) < count(plain, kMazeWall));
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
