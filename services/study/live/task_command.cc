#include "study/live/task_command.h"

#include <fmt/format.h>

#include <filesystem>

#include "common/cli/cli.h"
#include "common/runtime/log.h"
#include "common/runtime/threads.h"
#include "launcher/bus_place.h"
#include "launcher/domain_lease.h"
#include "study/live/task_session.h"

namespace conav::mapping_task {
namespace {

void Say(const std::string& line) {
  fmt::print("{}\n", line);
  std::fflush(stdout);
}

int Run(const std::string& program, const TaskOptions& options) {
  if (const auto valid = Validate(options); !valid) return Refused(program, valid.error().text);
  if (const auto port = launcher::CheckPort("--port", options.port); !port)
    return Failed(program, port.error());
  const SteadyClock clock;
  const auto program_folder = std::filesystem::read_symlink("/proc/self/exe").parent_path();
  auto session = TaskSession::Open(options, program_folder, clock, Say);
  if (!session && session.error().code == ErrorCode::kRefused) {
    return Refused(program, session.error().text);
  }
  if (!session) return Failed(program, session.error());
  Say("participant " + options.participant + "  folder " + FolderOf(options).string());
  const auto done = session->Run(ProcessStopToken());
  if (!done) return Failed(program, done.error());
  Say(*done ? "all mazes are finished" : "interrupted; the same command resumes");
  return *done ? 0 : 1;
}

}  // namespace

void AddTaskOptions(CLI::App& app, TaskOptions& options) {
  app.add_option("--participant", options.participant,
                 "Code of the participant, a pseudonym: 1 to 40 of A-Z a-z 0-9 _ -")
      ->required()
      ->type_name("CODE");
  app.add_option("--maze-seed", options.maze_seeds,
                 "Seeds of the mazes, one each [drawn by --seed and the participant's code]")
      ->delimiter(',')
      ->check(WholeNumber());
  app.add_option("--seed", options.seed, "Seed for drawing the maze seeds")
      ->check(WholeNumber())
      ->capture_default_str();
  app.add_option("--preset", options.preset, "Maze preset; `conav maze --help` lists them")
      ->capture_default_str();
  app.add_option("--camera", options.camera,
                 "egl renders pictures; none sends them without pixels, for tests")
      ->capture_default_str();
  app.add_option("--speed", options.speed, "Simulation time over wall time: how fast robots drive")
      ->capture_default_str();
  app.add_option("--port", options.port, "Port of the page on this machine; 0 = any free one")
      ->check(CLI::Range(0, 65535))
      ->capture_default_str();
  app.add_option("--dds", options.dds, "cyclonedds, fastdds, mixed or SERVICE=VENDOR,...");
  app.add_option("--domain", options.domain, "DDS domain [CONAV_DOMAIN or the first free one]");
  app.add_option("--out", options.out,
                 "Folder of the participant [runs/mapping-CODE, in a study runs/study-CODE]");
}

int RunTaskCommand(const std::string& program, const TaskOptions& options) {
  log::SetService("mapping-task");
  log::SetMinimumLevel(log::Level::kWarning);
  InstallStopSignals();
  try {
    return Run(program, options);
  } catch (const launcher::UsageError& error) {
    return Refused(program, error.what());
  } catch (const std::exception& error) {
    return Failed(program, {ErrorCode::kUnavailable, error.what()});
  }
}

}  // namespace conav::mapping_task
