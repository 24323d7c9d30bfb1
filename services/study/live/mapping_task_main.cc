#include <CLI/CLI.hpp>

#include "common/cli/cli.h"
#include "study/live/session.h"

// conav-mapping-task: people correct wrong maps, as training data for perception models.

namespace {

constexpr const char* kProgram = "conav mapping-task";

constexpr const char* kAbout =
    R"(The mapping task of the paper (Appendix A): a participant corrects the wrong map of one maze after
the other, in the browser. Each time they ask for the next picture, the robot, which knows the maze and
their map of it, drives to its next stop and sends one picture in a random direction: first at all goals,
then at random places, mostly where the map is wrong. Once the robot has reached all goals, they may
finish the maze or continue. Page, folder and data: docs/mapping-task.md.

The folder gets segments.pb.zst and pictures/, the training data of ./conav train, and result.json with
the mapping accuracy of each map (the share of corrected errors, less the broken cells). Every segment is
on disk at once. A service that dies is started again; after Ctrl-C or a kill the same command begins
the same maze again.)";

constexpr const char* kExamples =
    R"(Examples:
  conav mapping-task --participant P07
  conav mapping-task --participant P07 --maze-seed 7,234,666 --out data/P07
  conav dataset describe runs/mapping-P07/segments.pb.zst

Exit codes: 0 all mazes finished; 1 interrupted, a service cannot run, the port is taken, writing failed;
2 wrong usage.)";

}  // namespace

int main(int argc, char** argv) {
  using namespace conav::live_study;
  CLI::App app(kAbout, kProgram);
  SessionOptions options;
  MappingOptions mapping;
  MazeOptions& maze = mapping.maze;
  AddSessionOptions(app, options);
  conav::AddShown(app, "--mazes", mapping.mazes, "Mazes");
  app.add_option("--maze-seed", mapping.layouts,
                 "Seeds of the mazes, one each [drawn by --seed and the participant's code]")
      ->delimiter(',')
      ->check(conav::WholeNumber());
  app.add_option("--seed", mapping.seed, "Seed for drawing the maze seeds")
      ->check(conav::WholeNumber())
      ->capture_default_str();
  conav::AddShown(app, "--preset", maze.preset, "Maze preset; `conav maze --help` lists them");
  conav::AddShown(app, "--camera", maze.camera,
                  "egl renders pictures; none sends them without pixels, for tests");
  app.add_option("--speed", maze.speed, "Simulation time over wall time: how fast robots drive")
      ->check(conav::Between(0.01, 1000.0))
      ->capture_default_str();
  app.add_option("--out", options.out, "Folder of the participant [runs/mapping-CODE]");
  app.footer(kExamples);
  if (const auto ended = conav::Parse(app, argc, argv)) return *ended;
  // Without --mazes, the number of seeds decides.
  if (app.count("--mazes") == 0 && !mapping.layouts.empty()) {
    mapping.mazes = static_cast<int>(mapping.layouts.size());
  }
  mapping.participant = options.participant;
  if (options.out.empty()) options.out = "runs/mapping-" + options.participant;
  return RunGuarded(kProgram, [&] {
    const auto valid = Validate(options);
    if (!valid) return conav::Refused(kProgram, valid.error().text);
    const auto plan = PlanMappingTask(mapping);
    if (!plan) return conav::Refused(kProgram, plan.error().text);
    const std::filesystem::path folder = std::filesystem::absolute(options.out);
    return RunSession(kProgram, *plan, options, folder, {folder, ""});
  });
}
