// conav-mapping-task: people correct wrong maps, for perception models to learn from.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>

#include "common/console/console.h"
#include "common/console/option_checks.h"
#include "common/runtime/log.h"
#include "common/runtime/stop_token.h"
#include "launcher/bus_place.h"
#include "mapping_task/port_check.h"
#include "mapping_task/task_session.h"

namespace {

using namespace conav;

constexpr const char* kProgram = "conav mapping-task";

constexpr const char* kAbout =
    R"(The mapping task of the paper (Appendix A): a participant corrects the wrong map of one maze after
the other, in the browser. Each time they ask for the next picture, the robot, which knows the maze and
their map of it, drives to its next stop and sends one picture in a random direction: first all goals,
then random places, rather where the map is wrong. When the robot has reached all goals, they may finish
the maze, or go on. Page, folder and data: docs/mapping-task.md.

The folder gets segments.pb.zst and pictures/, what ./conav train learns from, and result.json: how
accurate each map became (mapping accuracy: the share of the mistakes corrected, less what was broken).
Every segment is on disk at once. After Ctrl-C or a kill the same command goes on at the first maze that
was not finished; that maze begins anew.)";

constexpr const char* kExamples =
    R"(Examples:
  conav mapping-task --participant P07
  conav mapping-task --participant P07 --maze-seed 7,234,666 --out data/P07
  conav dataset describe runs/mapping-P07/segments.pb.zst

Exit codes: 0 all mazes finished; 1 interrupted, a service died, the port is taken, writing failed;
2 wrong use.)";

void AddOptions(CLI::App& app, mapping_task::TaskOptions& options) {
  app.add_option("--participant", options.participant,
                 "Code of the participant, a pseudonym: 1 to 40 of A-Z a-z 0-9 _ -")
      ->required()
      ->type_name("CODE");
  app.add_option("--mazes", options.mazes, "Mazes")->capture_default_str();
  app.add_option("--maze-seed", options.maze_seeds,
                 "Seeds of the mazes, one each [drawn by --seed and the participant's code]")
      ->delimiter(',')
      ->check(WholeNumber());
  app.add_option("--seed", options.seed, "Seed of the seeds")
      ->check(WholeNumber())
      ->capture_default_str();
  app.add_option("--preset", options.preset, "Maze preset; `conav maze --help` lists them")
      ->capture_default_str();
  app.add_option("--camera", options.camera,
                 "egl renders pictures; none sends them without pixels, for tests")
      ->capture_default_str();
  app.add_option("--speed", options.speed, "Simulation time over wall time: how fast robots drive")
      ->capture_default_str();
  app.add_option("--port", options.port, "Port of the page on this machine; 0 = any that is free")
      ->check(CLI::Range(0, 65535))
      ->capture_default_str();
  app.add_option("--dds", options.dds, "cyclonedds, fastdds, mixed or SERVICE=VENDOR,...");
  app.add_option("--domain", options.domain, "DDS domain [CONAV_DOMAIN or the first that is free]");
  app.add_option("--out", options.out, "Folder of the participant [runs/mapping-CODE]");
  app.footer(kExamples);
}

void Say(const std::string& line) {
  fmt::print("{}\n", line);
  std::fflush(stdout);
}

int Run(const mapping_task::TaskOptions& options) {
  if (const auto valid = mapping_task::Validate(options); !valid) {
    return Refused(kProgram, valid.error().text);
  }
  if (const auto port = mapping_task::CheckPort(options.port); !port) {
    return Failed(kProgram, port.error());
  }
  const SteadyClock clock;
  const auto program_folder = std::filesystem::read_symlink("/proc/self/exe").parent_path();
  auto session = mapping_task::TaskSession::Open(options, program_folder, clock, Say);
  if (!session && session.error().code == ErrorCode::kRefused) {
    return Refused(kProgram, session.error().text);
  }
  if (!session) return Failed(kProgram, session.error());
  Say("participant " + options.participant + "  folder " + FolderOf(options).string());
  const auto done = session->Run(ProcessStopToken());
  if (!done) return Failed(kProgram, done.error());
  if (*done) Say("all mazes are finished");
  if (!*done) Say("interrupted; the same command goes on");
  return *done ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(kAbout, kProgram);
  mapping_task::TaskOptions options;
  AddOptions(app, options);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  // Without --mazes there are as many as seeds.
  if (app.count("--mazes") == 0 && !options.maze_seeds.empty()) {
    options.mazes = static_cast<int>(options.maze_seeds.size());
  }
  log::SetService("mapping-task");
  log::SetMinimumLevel(log::Level::kWarning);
  InstallStopSignals();
  try {
    return Run(options);
  } catch (const launcher::UsageError& error) {
    return Refused(kProgram, error.what());
  } catch (const std::exception& error) {
    return Failed(kProgram, {ErrorCode::kUnavailable, error.what()});
  }
}
