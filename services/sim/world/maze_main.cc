#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "common/cli/cli.h"
#include "common/runtime/config.h"
#include "common/runtime/file.h"
#include "common/runtime/text.h"
#include "sim/world/maze_presets.h"
#include "sim/world/world_spec.h"

// conav-maze: prints one maze, entity layer and variation layer, or a waterway and the operator's
// map of it.

namespace {

using conav::sim::Maze;
using conav::sim::RandomMazeOptions;

struct Arguments {
  std::string preset = "conav13";
  RandomMazeOptions maze;
  bool no_simplify = false;
  std::uint64_t seed = 1;
  std::uint32_t paper_seed = 0;
  int generation = 1;
  std::string json;
  bool scenarios = false;
};

void AddSizeFlags(CLI::App& app, Arguments& arguments, CLI::Option* preset) {
  RandomMazeOptions& maze = arguments.maze;
  auto* height = app.add_option("--height", maze.height, "cells with the outer wall, odd");
  auto* width = app.add_option("--width", maze.width, "cells with the outer wall, odd");
  height->needs(width)->excludes(preset);
  width->needs(height)->excludes(preset);
  app.add_option("--max-rooms", maze.max_rooms, "0 = as many as fit")
      ->excludes(preset)
      ->capture_default_str();
  app.add_option("--room-min", maze.room_min_size, "shortest side of a room")
      ->excludes(preset)
      ->capture_default_str();
  app.add_option("--room-max", maze.room_max_size, "longest side of a room")
      ->excludes(preset)
      ->capture_default_str();
}

void AddStyleFlags(CLI::App& app, Arguments& arguments) {
  RandomMazeOptions& maze = arguments.maze;
  conav::AddShown(app, "--extra-connection-probability", maze.extra_connection_probability,
                  "probability of a second opening between two regions, in [0, 1]");
  app.add_flag("--no-simplify", arguments.no_simplify, "keep dead ends and bends");
  app.add_flag("--doors", maze.has_doors, "H and I where regions meet");
  conav::AddShown(app, "--spawns-per-room", maze.spawns_per_room, "");
  conav::AddShown(app, "--objects-per-room", maze.objects_per_room, "");
}

void AddFlags(CLI::App& app, Arguments& arguments) {
  std::string presets;
  for (const auto& preset : conav::sim::MazePresets()) {
    presets += fmt::format("\n  {}: {}", preset.name, preset.description);
  }
  presets += fmt::format("\n  {}: 150 x 150 cells of water and land, and the operator's map of it",
                         conav::sim::kWaterwayPreset);
  auto* preset = app.add_option("--preset", arguments.preset, "one of" + presets);
  preset->capture_default_str();
  AddSizeFlags(app, arguments, preset);
  AddStyleFlags(app, arguments);
  auto* seed = app.add_option("--seed", arguments.seed,
                              "labmaze's own seed, passed to the generator unchanged");
  seed->check(conav::WholeNumber())->capture_default_str();
  auto* paper_seed = app.add_option("--paper-seed", arguments.paper_seed,
                                    "a seed of the paper (234, 666, 9), mapped to labmaze's seed "
                                    "as in MemoryMaze; shows generation 2 by default");
  paper_seed->check(conav::WholeNumber())->excludes(seed);
  app.add_option("--generation", arguments.generation,
                 "1 = the first maze of a labmaze object, 2 = after one regeneration, ...")
      ->check(conav::Between(1, 1000000))
      ->capture_default_str();
  app.add_option("--json", arguments.json, "write JSON to this file, - = standard output")
      ->expected(0, 1)
      ->check(conav::WritableFile())
      ->default_str("-");
}

/// Applies the preset and the paper seed; the preset's name, empty when sizes were given.
conav::Result<std::string> Complete(const CLI::App& app, Arguments& arguments) {
  RandomMazeOptions& options = arguments.maze;
  options.simplify = !arguments.no_simplify;
  if (app.count("--paper-seed") > 0) {
    arguments.seed = conav::sim::MazeSeedFromPaperSeed(arguments.paper_seed);
    if (app.count("--generation") == 0) {
      arguments.generation = conav::sim::kFirstEpisodeGeneration;
    }
  }
  for (const char* flag : {"--height", "--max-rooms", "--room-min", "--room-max"}) {
    if (app.count(flag) > 0) return std::string();
  }
  const auto preset = conav::sim::FindMazePreset(arguments.preset);
  if (!preset) return tl::unexpected(preset.error());
  options.height = preset->options.height;
  options.width = preset->options.width;
  options.max_rooms = preset->options.max_rooms;
  options.room_min_size = preset->options.room_min_size;
  options.room_max_size = preset->options.room_max_size;
  return arguments.preset;
}

nlohmann::ordered_json ToJson(const Arguments& arguments, const std::string& preset,
                              const Maze& maze) {
  const RandomMazeOptions& options = arguments.maze;
  return {{"preset", preset},
          {"height", options.height},
          {"width", options.width},
          {"max_rooms", options.max_rooms},
          {"room_min_size", options.room_min_size},
          {"room_max_size", options.room_max_size},
          {"extra_connection_probability", options.extra_connection_probability},
          {"simplify", options.simplify},
          {"has_doors", options.has_doors},
          {"spawns_per_room", options.spawns_per_room},
          {"objects_per_room", options.objects_per_room},
          {"seed", arguments.seed},
          {"generation", arguments.generation},
          {"rooms", maze.rooms},
          {"entity", conav::sim::ToLines(maze.entities)},
          {"variations", conav::sim::ToLines(maze.variations)}};
}

std::string Text(const Maze& maze) {
  return fmt::format("{}\n\n{}\n", conav::Join(conav::sim::ToLines(maze.entities), "\n"),
                     conav::Join(conav::sim::ToLines(maze.variations), "\n"));
}

/// Land, water, start and goal, or land and water as the operator knows them.
std::vector<std::string> Lines(const conav::OccupancyGrid& map, const conav::sim::WorldSpec* spec) {
  conav::Grid<char> drawing(map.rows(), map.columns(), conav::sim::kMazeFree);
  for (std::size_t i = 0; i < map.size(); ++i) {
    if (map.values()[i] == conav::Occupancy::kOccupied) {
      drawing.values()[i] = conav::sim::kMazeWall;
    }
  }
  if (spec != nullptr) {
    drawing[spec->starts.front()] = conav::sim::kMazeSpawn;
    drawing[spec->goals.front().front()] = conav::sim::kMazeObject;
  }
  return conav::sim::ToLines(drawing);
}

/// The waterway that `sim: {preset: waterway, seed: N}` gives.
int PrintWaterway(const CLI::App& app, const Arguments& arguments, const char* program) {
  for (const char* flag : {"--paper-seed", "--generation"}) {
    if (app.count(flag) > 0) {
      return conav::Refused(program, fmt::format("{} is for mazes, not a waterway", flag));
    }
  }
  conav::sim::WorldOptions options;
  options.preset = arguments.preset;
  options.seed = arguments.seed;
  const auto spec = conav::sim::MakeWorldSpec(options);
  if (!spec) return conav::Refused(program, spec.error().text);
  const auto truth = Lines(spec->truth, &*spec);
  const auto plan = Lines(spec->human_map, nullptr);
  if (app.count("--json") == 0) {
    return conav::ExitCode(
        program, conav::WriteStandardOutput(
                     fmt::format("{}\n\n{}\n", conav::Join(truth, "\n"), conav::Join(plan, "\n"))));
  }
  const nlohmann::ordered_json json = {
      {"preset", arguments.preset}, {"seed", arguments.seed}, {"entity", truth}, {"plan", plan}};
  return conav::ExitCode(
      program, conav::WriteJsonOutput(arguments.json.empty() ? "-" : arguments.json, json));
}

int PrintScenarios(const char* program) {
  const auto document = conav::ReadYamlFile(conav::ShippedFile("config/scenarios.yaml"));
  if (!document) return conav::Failed(program, document.error());
  std::string text;
  for (const auto& entry : (*document)["scenarios"]) {
    text += fmt::format("{:17} {}\n", entry.first.Scalar(), entry.second["about"].Scalar());
  }
  return conav::ExitCode(program, conav::WriteStandardOutput(text));
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{
      "Prints a maze: its entity layer (* wall, P spawn, G object, H and I doors) and its "
      "variation\n"
      "layer (a letter per room). Equal to labmaze's maze of the same options, character for "
      "character.\n"
      "--preset waterway prints the waterway of a seed (* land, P start, G goal) and the "
      "operator's "
      "map of it.",
      "conav maze"};
  Arguments arguments;
  AddFlags(app, arguments);
  app.add_flag("--scenarios", arguments.scenarios,
               "Lists the tasks of --scenario (deploy/config/scenarios.yaml) instead");
  if (const auto ended = conav::Parse(app, argc, argv)) return *ended;
  constexpr const char* kProgram = "conav-maze";
  if (arguments.scenarios) return PrintScenarios(kProgram);
  if (app.count("--preset") > 0 && arguments.preset == conav::sim::kWaterwayPreset) {
    return PrintWaterway(app, arguments, kProgram);
  }
  const auto preset = Complete(app, arguments);
  if (!preset) return conav::Refused(kProgram, preset.error().text);
  if (const auto valid = conav::sim::CheckMazeOptions(arguments.maze); !valid) {
    return conav::Refused(kProgram, valid.error().text);
  }
  const Maze maze = conav::sim::GenerateMaze(arguments.maze, arguments.seed, arguments.generation);
  if (app.count("--json") == 0) {
    return conav::ExitCode(kProgram, conav::WriteStandardOutput(Text(maze)));
  }
  const std::string json = arguments.json.empty() ? "-" : arguments.json;
  return conav::ExitCode(kProgram, conav::WriteJsonOutput(json, ToJson(arguments, *preset, maze)));
}
