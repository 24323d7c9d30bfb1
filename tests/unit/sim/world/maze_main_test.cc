#include <fmt/core.h>

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>
#include <string>

#include "common/runtime/text.h"
#include "sim/world/maze_presets.h"
#include "sim/world/world_spec.h"
#include "support/program_runner.h"

namespace conav::sim {
namespace {

test::ProgramOutcome RunMaze(const std::string& arguments) {
  return test::RunProgram("conav-maze", arguments);
}

std::string TextOf(const Maze& maze) {
  return fmt::format("{}\n\n{}\n", Join(ToLines(maze.entities), "\n"),
                     Join(ToLines(maze.variations), "\n"));
}

TEST_CASE("conav-maze prints the entity layer, a blank line and the variation layer", "[maze]") {
  const auto outcome = RunMaze("--preset 9x9 --seed 3 --generation 2");
  CHECK(outcome.exit_code == 0);
  CHECK(outcome.out == TextOf(GenerateMaze(FindMazePreset("9x9").value().options, 3, 2)));
  // The paper's first episode.
  CHECK(RunMaze("--paper-seed 234").out ==
        TextOf(GenerateMaze(FindMazePreset("conav13").value().options, 133003720, 2)));
}

TEST_CASE("conav-maze takes every size and style as a flag", "[maze]") {
  const RandomMazeOptions options{.height = 9,
                                  .width = 15,
                                  .max_rooms = 3,
                                  .room_min_size = 1,
                                  .room_max_size = 3,
                                  .extra_connection_probability = 0.25,
                                  .simplify = false,
                                  .has_doors = true};
  const auto outcome = RunMaze(
      "--height 9 --width 15 --max-rooms 3 --room-min 1 --room-max 3 "
      "--extra-connection-probability 0.25 --no-simplify --doors --seed 12 --generation 1");
  CHECK(outcome.exit_code == 0);
  CHECK(outcome.out == TextOf(GenerateMaze(options, 12, 1)));
}

TEST_CASE("conav-maze --json holds both layers and what they were made from", "[maze]") {
  const nlohmann::json document = nlohmann::json::parse(RunMaze("--seed 5 --json").out);
  const Maze maze = GenerateMaze(FindMazePreset("conav13").value().options, 5, 1);
  CHECK(document["entity"] == ToLines(maze.entities));
  CHECK(document["variations"] == ToLines(maze.variations));
  CHECK(document["seed"] == 5);
  CHECK(document["height"] == 13);
  CHECK(document["preset"] == "conav13");
}

TEST_CASE("conav-maze prints a waterway and the operator's map of it", "[maze]") {
  const nlohmann::json document =
      nlohmann::json::parse(RunMaze("--preset waterway --seed 5 --json").out);
  WorldOptions options;
  options.preset = kWaterwayPreset;
  options.seed = 5;
  const auto spec = MakeWorldSpec(options);
  REQUIRE(spec);
  const auto at = [&](const char* layer, Cell cell) {
    return document[layer][static_cast<std::size_t>(cell.row)]
        .get<std::string>()[static_cast<std::size_t>(cell.column)];
  };
  CHECK(at("entity", spec->starts.front()) == kMazeSpawn);
  CHECK(at("entity", spec->goals.front().front()) == kMazeObject);
  for (std::size_t i = 0; i < spec->human_map.size(); ++i) {
    const bool land = spec->human_map.values()[i] == Occupancy::kOccupied;
    REQUIRE((at("plan", spec->human_map.CellAt(i)) == kMazeWall) == land);
  }
  CHECK(RunMaze("--preset waterway --generation 2").exit_code == 2);
}

TEST_CASE("conav-maze refuses impossible mazes by name", "[maze]") {
  CHECK_THAT(RunMaze("--height 12 --width 13").error, Catch::Contains("height 12"));
  for (const char* wrong :
       {"--height 12 --width 13", "--preset nothing",
        "--height 13 --width 13 --room-min 5 --room-max 3", "--height 5 --width 5", "--height 13",
        "--generation 0", "--seed many", "--seed -1"}) {
    INFO(wrong);
    CHECK(RunMaze(wrong).exit_code == 2);
  }
}

}  // namespace
}  // namespace conav::sim
