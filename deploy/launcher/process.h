#pragma once

#include <sys/types.h>

#include <chrono>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/runtime/clock.h"
#include "common/runtime/result.h"

namespace conav::launcher {

/// How a process ended.
struct ProcessEnd {
  int exit_code = 0;
  int signal = 0;                // 0 = it exited normally
  std::string Describe() const;  // "exit code 1", "signal 9 (Killed)"
};

/// A child process. Its stdout and stderr go to a file; the kernel kills it when we die. Threads:
/// start it from a thread that lives as long as the child should (PR_SET_PDEATHSIG follows the
/// thread).
class Process {
 public:
  /// Starts `arguments[0]` (looked up in PATH) with the rest. Throws StartupError when the log
  /// cannot be opened or the program cannot be started (name and cause).
  Process(std::string name, const std::vector<std::string>& arguments,
          const std::filesystem::path& log);
  /// Sends SIGKILL if it still runs.
  ~Process();
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;

  const std::string& name() const { return name_; }
  pid_t pid() const { return pid_; }
  const std::filesystem::path& log() const { return log_; }
  const std::optional<ProcessEnd>& end() const { return end_; }
  bool running() const { return !end_; }

  /// Checks whether it has ended; never blocks.
  bool Poll();
  /// Does nothing after its end.
  void Signal(int signal);

 private:
  std::string name_;
  std::filesystem::path log_;
  pid_t pid_ = -1;
  std::optional<ProcessEnd> end_;
};

/// The last `count` lines of a text file; empty when it cannot be read.
std::vector<std::string> LastLines(const std::filesystem::path& file, std::size_t count);

/// When a process that ended starts again, and when not. Threads: one caller.
class RestartPolicy {
 public:
  static constexpr std::chrono::milliseconds kFirstDelay{
      100};  // twice as long after each further end
  static constexpr std::chrono::seconds kWindow{60};
  static constexpr std::size_t kMostEnds = 5;  // within kWindow
  /// A process that exits by itself, with an error, within so long refuses its configuration.
  static constexpr std::chrono::seconds kStart{5};

  /// It ran from `started` to `now`; returns when to start it again. Errors: kRefused: it refuses
  /// its configuration, or this is the kMostEnds-th end within kWindow.
  [[nodiscard]] Result<Clock::TimePoint> Ended(const ProcessEnd& end, Clock::TimePoint started,
                                               Clock::TimePoint now);

 private:
  std::vector<Clock::TimePoint> ends_;  // of the last kWindow
};

/// The processes of one run, started in order and stopped together.
class ProcessGroup {
 public:
  ~ProcessGroup();

  /// Throws StartupError, see Process.
  Process& Start(std::string name, const std::vector<std::string>& arguments,
                 const std::filesystem::path& log);

  /// The processes that ended since the last call.
  std::vector<const Process*> TakeEnded();

  std::vector<const Process*> running() const;

  /// Sends SIGTERM to all, then SIGKILL to those that still run after `grace`. Returns the names of
  /// the killed.
  std::vector<std::string> StopAll(std::chrono::milliseconds grace);
  /// The same for those that `meant` selects.
  std::vector<std::string> Stop(std::chrono::milliseconds grace,
                                const std::function<bool(const Process&)>& meant);

 private:
  std::vector<std::unique_ptr<Process>> processes_;
  std::vector<const Process*> reported_;
};

}  // namespace conav::launcher
