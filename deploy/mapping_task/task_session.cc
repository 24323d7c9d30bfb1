#include "mapping_task/task_session.h"

#include <fmt/format.h>

#include <utility>

#include "common/runtime/json.h"
#include "launcher/bus_place.h"
#include "launcher/episode.h"

namespace conav::mapping_task {
namespace {

namespace fs = std::filesystem;

constexpr int kMostAttempts = 1000;

/// A domain where nobody else's robot is; nobody has to listen there.
launcher::DomainLease FindDomain(const TaskOptions& options) {
  launcher::Episode episode = launcher::MakeEpisode(1, 1);
  launcher::BusPlace place = launcher::JoinFreeDomain(DemoOf(options, 0), episode);
  place.recorder.reset();
  return std::move(place.lease);
}

Maze MazeAt(const fs::path& folder, int number, int attempt, std::uint64_t seed) {
  return {number, attempt, seed, folder / fmt::format("maze-{}-{}", number, attempt)};
}

int PortOf(const std::string& url) { return std::stoi(url.substr(url.rfind(':') + 1)); }

}  // namespace

TaskSession::TaskSession(const TaskOptions& options, fs::path program_folder, const Clock& clock,
                         Say say, study::StudyFolder folder, launcher::DomainLease domain)
    : options_(options),
      program_folder_(std::move(program_folder)),
      clock_(clock),
      say_(std::move(say)),
      folder_(std::move(folder)),
      domain_(std::move(domain)),
      port_(options.port) {}

Result<TaskSession> TaskSession::Open(const TaskOptions& options, fs::path program_folder,
                                      const Clock& clock, Say say) {
  auto folder = study::StudyFolder::Open(fs::absolute(FolderOf(options)), DesignOf(options));
  if (!folder) return tl::unexpected(folder.error());
  TaskSession session(options, std::move(program_folder), clock, std::move(say), *std::move(folder),
                      FindDomain(options));
  if (auto read = session.ReadFinished(); !read) return tl::unexpected(read.error());
  return session;
}

Result<void> TaskSession::ReadFinished() {
  for (int number = 1; number <= options_.mazes; ++number) {
    std::optional<MazeResult> found;
    for (int attempt = 1; attempt < kMostAttempts && !found; ++attempt) {
      const Maze maze = MazeAt(folder_.path(), number, attempt, 0);
      if (!fs::exists(maze.folder)) break;
      auto result = ReadMazeResult(maze.result());
      if (!result) return tl::unexpected(result.error());
      found = *std::move(result);
    }
    if (!found) break;
    results_.push_back(*std::move(found));
  }
  return {};
}

Result<bool> TaskSession::Run(const StopToken& stop) {
  if (!results_.empty())
    say_(fmt::format("{} of {} mazes are finished", results_.size(), options_.mazes));
  while (static_cast<int>(results_.size()) < options_.mazes) {
    const auto maze = MakeMaze(static_cast<int>(results_.size()) + 1);
    if (!maze) return tl::unexpected(maze.error());
    const auto played = Play(*maze, stop);
    if (!played || !*played) return played;
  }
  return WriteReport().map([] { return true; });
}

Result<Maze> TaskSession::MakeMaze(int number) const {
  const std::uint64_t seed = SeedsOf(options_).at(static_cast<std::size_t>(number) - 1);
  for (int attempt = 1; attempt < kMostAttempts; ++attempt) {
    const Maze maze = MazeAt(folder_.path(), number, attempt, seed);
    std::error_code error;
    if (!fs::create_directory(maze.folder, error) && !error) continue;
    for (const char* part : {"config", "logs"}) {
      if (!error) fs::create_directory(maze.folder / part, error);
    }
    if (!error) return maze;
    return Fail(ErrorCode::kIo, fmt::format("{}: cannot make this folder: {}", maze.folder.string(),
                                            error.message()));
  }
  return Fail(ErrorCode::kRefused, fmt::format("maze {} was begun too often", number));
}

Result<bool> TaskSession::Play(const Maze& maze, const StopToken& stop) {
  MazeSetting setting{domain_.domain(), port_, {}, folder_.path()};
  for (const MazeResult& result : results_) setting.earlier.push_back(result.mapping_accuracy);
  MazeRun run(program_folder_, maze, clock_, say_);
  const MazeEnd end = run.Run(
      PlanMaze(options_, maze, setting), [&](const std::string& url) { Opened(maze, url); }, stop);
  if (end == MazeEnd::kInterrupted) return false;
  if (end == MazeEnd::kServiceDied) {
    return Fail(ErrorCode::kUnavailable,
                fmt::format("maze {} was broken off; the same command goes on there", maze.number));
  }
  auto result = ReadMazeResult(maze.result());
  if (!result) return tl::unexpected(result.error());
  say_(MazeLine(maze.number, **result));
  results_.push_back(**std::move(result));
  return WriteReport().map([] { return true; });
}

void TaskSession::Opened(const Maze& maze, const std::string& url) {
  port_ = PortOf(url);
  say_(fmt::format("maze {} of {} (method {}, seed {}): {}", maze.number, options_.mazes,
                   MethodOf(options_, maze.number), maze.seed, url));
}

Result<void> TaskSession::WriteReport() const {
  return WriteJsonFile(folder_.path() / "result.json", TaskJson(options_, results_));
}

}  // namespace conav::mapping_task
