#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "common/runtime/clock.h"
#include "common/runtime/stop_token.h"
#include "launcher/process_group.h"
#include "mapping_task/maze_plan.h"

namespace conav::mapping_task {

enum class MazeEnd { kFinished, kInterrupted, kServiceDied };

/// The services of one maze, from their start until the participant has finished.
/// Threads: one.
class MazeRun {
 public:
  using Say = std::function<void(const std::string&)>;
  using Opened = std::function<void(const std::string& url)>;

  /// `program_folder` holds conav-sim and the others; all references outlive it.
  MazeRun(const std::filesystem::path& program_folder, const Maze& maze, const Clock& clock,
          Say say);

  /// Starts `services`, and waits. `opened` is called with the page's address. All services are
  /// gone afterwards. Throws StartupError when one cannot be started or a file not be written.
  MazeEnd Run(const std::vector<PlannedService>& services, const Opened& opened,
              const StopToken& stop);

 private:
  void Start(const PlannedService& service);
  MazeEnd Wait(const Opened& opened, const StopToken& stop);
  /// Whether the page's address is known; `opened` was told then.
  bool TellAddress(const Opened& opened) const;
  bool TellDeaths();
  /// Pages get the result before the service goes.
  void Linger(const StopToken& stop);

  std::filesystem::path program_folder_;
  const Maze& maze_;
  const Clock& clock_;
  Say say_;
  launcher::ProcessGroup processes_;
};

}  // namespace conav::mapping_task
