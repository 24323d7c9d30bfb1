#include <CLI/CLI.hpp>

#include "common/cli/cli.h"
#include "study/live/task_command.h"

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
on disk at once. After Ctrl-C or a kill the same command resumes at the first unfinished maze, which
starts again.)";

constexpr const char* kExamples =
    R"(Examples:
  conav mapping-task --participant P07
  conav mapping-task --participant P07 --maze-seed 7,234,666 --out data/P07
  conav dataset describe runs/mapping-P07/segments.pb.zst

Exit codes: 0 all mazes finished; 1 interrupted, a service died, the port is taken, writing failed;
2 wrong usage.)";

}  // namespace

int main(int argc, char** argv) {
  using namespace conav::mapping_task;
  CLI::App app(kAbout, kProgram);
  TaskOptions options;
  AddTaskOptions(app, options);
  app.add_option("--mazes", options.mazes, "Mazes")->capture_default_str();
  app.footer(kExamples);
  if (const auto ended = conav::Parse(app, argc, argv)) return *ended;
  // Without --mazes, the number of seeds decides.
  if (app.count("--mazes") == 0 && !options.maze_seeds.empty()) {
    options.mazes = static_cast<int>(options.maze_seeds.size());
  }
  return RunTaskCommand(kProgram, options);
}
