#include "mapping_task/maze_run.h"

#include <fmt/format.h>
#include <poll.h>

#include <chrono>

#include "common/runtime/file.h"

namespace conav::mapping_task {
namespace {

using namespace std::chrono_literals;

constexpr auto kPeriod = 50ms;
constexpr auto kLinger = 1s;
constexpr auto kGrace = 5s;
constexpr std::size_t kLogLines = 8;

void WaitAMoment() { poll(nullptr, 0, static_cast<int>(kPeriod.count())); }

}  // namespace

MazeRun::MazeRun(const std::filesystem::path& program_folder, const Maze& maze, const Clock& clock,
                 Say say)
    : program_folder_(program_folder), maze_(maze), clock_(clock), say_(std::move(say)) {}

MazeEnd MazeRun::Run(const std::vector<PlannedService>& services, const Opened& opened,
                     const StopToken& stop) {
  for (const PlannedService& service : services) Start(service);
  const MazeEnd end = Wait(opened, stop);
  if (end == MazeEnd::kFinished) Linger(stop);
  for (const std::string& name : processes_.StopAll(kGrace)) {
    say_(name + " did not stop when asked and was killed");
  }
  return end;
}

void MazeRun::Start(const PlannedService& service) {
  if (const auto written = WriteFile(maze_.config(service.name), service.config); !written) {
    throw StartupError(written.error().text);
  }
  processes_.Start(service.name,
                   {(program_folder_ / ("conav-" + service.name)).string(), "--config",
                    maze_.config(service.name).string()},
                   maze_.log(service.name));
}

MazeEnd MazeRun::Wait(const Opened& opened, const StopToken& stop) {
  bool open = false;
  while (true) {
    open = open || TellAddress(opened);
    if (std::filesystem::exists(maze_.result())) return MazeEnd::kFinished;
    if (TellDeaths()) return MazeEnd::kServiceDied;
    if (stop.stop_requested()) return MazeEnd::kInterrupted;
    WaitAMoment();
  }
}

bool MazeRun::TellAddress(const Opened& opened) const {
  const auto url = ReadFile(maze_.url());
  if (url) opened(url->substr(0, url->find('\n')));
  return url.has_value();
}

bool MazeRun::TellDeaths() {
  bool died = false;
  for (const launcher::Process* process : processes_.TakeEnded()) {
    died = died || process->name() != kRecorder;
    say_(fmt::format("{} (pid {}) died: {}; the end of its log:", process->name(), process->pid(),
                     process->end()->Describe()));
    for (const std::string& line : launcher::LastLines(process->log(), kLogLines)) {
      say_("  | " + line);
    }
  }
  return died;
}

void MazeRun::Linger(const StopToken& stop) {
  const auto until = clock_.Now() + kLinger;
  while (clock_.Now() < until && !stop.stop_requested()) WaitAMoment();
}

}  // namespace conav::mapping_task
