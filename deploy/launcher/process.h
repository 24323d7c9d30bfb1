#pragma once

#include <sys/types.h>

#include <chrono>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace conav::launcher {

/// How a process ended.
struct ProcessEnd {
  int exit_code = 0;
  int signal = 0;                // 0 = it exited by itself
  std::string Describe() const;  // "exit code 1", "signal 9 (Killed)"
};

/// A child process of ours. Its stdout and stderr go to a file; it is killed when we die.
/// Threads: start it from the thread that lives as long as the children are wanted
/// (PR_SET_PDEATHSIG follows the thread).
class Process {
 public:
  /// Starts `arguments[0]` (looked up in PATH) with the rest. Throws StartupError when the log
  /// cannot be opened or the program cannot be started (name and cause).
  Process(std::string name, const std::vector<std::string>& arguments,
          const std::filesystem::path& log);
  /// SIGKILL when it still runs.
  ~Process();
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;

  const std::string& name() const { return name_; }
  pid_t pid() const { return pid_; }
  const std::filesystem::path& log() const { return log_; }
  const std::optional<ProcessEnd>& end() const { return end_; }
  bool running() const { return !end_; }

  /// Looks whether it has ended; never blocks.
  bool Poll();
  /// Nothing when it has ended.
  void Signal(int signal);

 private:
  std::string name_;
  std::filesystem::path log_;
  pid_t pid_ = -1;
  std::optional<ProcessEnd> end_;
};

/// The last `count` lines of a text file; empty when it cannot be read.
std::vector<std::string> LastLines(const std::filesystem::path& file, std::size_t count);

/// The processes of one run, started in order and stopped together.
class ProcessGroup {
 public:
  ~ProcessGroup();

  /// Throws StartupError, see Process.
  Process& Start(std::string name, const std::vector<std::string>& arguments,
                 const std::filesystem::path& log);

  /// Those that ended since the last call.
  std::vector<const Process*> TakeEnded();

  /// How many of those that `meant` picks have not ended, as far as TakeEnded() has seen.
  int CountRunning(const std::function<bool(const Process&)>& meant) const;

  /// SIGTERM to all, SIGKILL to those that still run after `grace`. Returns the names of the
  /// killed.
  std::vector<std::string> StopAll(std::chrono::milliseconds grace);
  /// The same for those that `meant` picks.
  std::vector<std::string> Stop(std::chrono::milliseconds grace,
                                const std::function<bool(const Process&)>& meant);

 private:
  std::vector<std::unique_ptr<Process>> processes_;
  std::vector<const Process*> reported_;
};

}  // namespace conav::launcher
