#include <sys/wait.h>

#include <array>
#include <catch2/catch.hpp>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <string>

#include "sim/world/maze_presets.h"

namespace conav::sim {
namespace {

struct Outcome {
  int exit_code = -1;
  std::string text;  // standard output and error
};

Outcome RunMaze(const std::string& arguments) {
  const std::string command = std::string(CONAV_BIN_DIR "/conav-maze ") + arguments + " 2>&1";
  std::FILE* pipe = popen(command.c_str(), "r");
  REQUIRE(pipe != nullptr);
  Outcome outcome;
  std::array<char, 4096> buffer{};
  std::size_t count = 0;
  while ((count = std::fread(buffer.data(), 1, buffer.size(), pipe)) > 0) {
    outcome.text.append(buffer.data(), count);
  }
  outcome.exit_code = WEXITSTATUS(pclose(pipe));
  return outcome;
}

std::string TextOf(const Maze& maze) {
  std::string text;
  for (const std::string& line : ToLines(maze.entities)) text += line + "\n";
  text += "\n";
  for (const std::string& line : ToLines(maze.variations)) text += line + "\n";
  return text;
}

TEST_CASE("conav-maze prints the entity layer, a blank line and the variation layer",
          "[sim][maze]") {
  const Outcome outcome = RunMaze("--preset 9x9 --seed 3 --generation 2");
  CHECK(outcome.exit_code == 0);
  CHECK(outcome.text == TextOf(GenerateMaze(FindMazePreset("9x9").value().options, 3, 2)));
}

TEST_CASE("conav-maze takes every size and style as a flag", "[sim][maze]") {
  RandomMazeOptions options;
  options.height = 9;
  options.width = 15;
  options.max_rooms = 3;
  options.room_min_size = 1;
  options.room_max_size = 3;
  options.extra_connection_probability = 0.25;
  options.simplify = false;
  options.has_doors = true;
  const Outcome outcome = RunMaze(
      "--height 9 --width 15 --max-rooms 3 --room-min 1 --room-max 3 "
      "--extra-connection-probability 0.25 --no-simplify --doors --seed 12 --generation 1");
  CHECK(outcome.exit_code == 0);
  CHECK(outcome.text == TextOf(GenerateMaze(options, 12, 1)));
}

TEST_CASE("conav-maze --paper-seed shows the paper's first episode", "[sim][maze]") {
  const Outcome outcome = RunMaze("--paper-seed 234");
  CHECK(outcome.text ==
        TextOf(GenerateMaze(FindMazePreset("conav13").value().options, 133003720, 2)));
}

TEST_CASE("conav-maze --json holds both layers and what they were made from", "[sim][maze]") {
  const nlohmann::json document = nlohmann::json::parse(RunMaze("--seed 5 --json").text);
  const Maze maze = GenerateMaze(FindMazePreset("conav13").value().options, 5, 1);
  CHECK(document["entity"] == ToLines(maze.entities));
  CHECK(document["variations"] == ToLines(maze.variations));
  CHECK(document["seed"] == 5);
  CHECK(document["height"] == 13);
  CHECK(document["preset"] == "conav13");
}

TEST_CASE("conav-maze refuses impossible mazes by name, with exit code 2", "[sim][maze]") {
  const Outcome even = RunMaze("--height 12 --width 13");
  CHECK(even.exit_code == 2);
  CHECK(even.text == "conav-maze: height 12 is even: must be odd\n");
  CHECK(RunMaze("--preset nothing").exit_code == 2);
  CHECK(RunMaze("--height 13 --width 13 --room-min 5 --room-max 3").exit_code == 2);
  CHECK(RunMaze("--height 5 --width 5").exit_code == 2);
  CHECK(RunMaze("--height 13").exit_code == 2);
  CHECK(RunMaze("--generation 0").exit_code == 2);
  CHECK(RunMaze("--seed many").exit_code == 2);
  CHECK(RunMaze("--seed -1").exit_code == 2);
  CHECK(RunMaze("--unknown").exit_code == 2);
}

TEST_CASE("conav-maze refuses an output that cannot be written", "[sim][maze]") {
  CHECK(RunMaze("--json /nonexistent/folder/maze.json").exit_code == 2);
}

}  // namespace
}  // namespace conav::sim
