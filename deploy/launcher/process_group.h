#pragma once

#include <chrono>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "launcher/process.h"

namespace conav::launcher {

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
