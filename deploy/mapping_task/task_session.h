#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "common/runtime/clock.h"
#include "common/runtime/result.h"
#include "common/runtime/stop_token.h"
#include "launcher/domain_lease.h"
#include "mapping_task/maze_run.h"
#include "mapping_task/task_options.h"
#include "mapping_task/task_report.h"
#include "study/study_folder.h"

namespace conav::mapping_task {

/// One participant's mazes, one after the other at one address; goes on at the first that was not
/// finished. Its folder holds
///
///   study.json       participant and mazes
///   segments.pb.zst  what perception models learn from, with pictures/; every segment at once
///   result.json      after each maze (TaskJson)
///   maze-<number>-<attempt>/   see Maze
///
/// A maze that was broken off begins anew; the segments of before stay, as a trajectory of their own.
/// Threads: one.
class TaskSession {
 public:
  using Say = std::function<void(const std::string&)>;

  /// Errors: kRefused (the folder is another participant's, has other mazes, other files, or is in
  /// use), kIo, kMalformed. Throws launcher::UsageError when the DDS domain is taken.
  [[nodiscard]] static Result<TaskSession> Open(const TaskOptions& options,
                                                std::filesystem::path program_folder,
                                                const Clock& clock, Say say);

  /// True when all mazes are finished. Errors: kIo, kUnavailable (a service died). Throws
  /// StartupError as MazeRun does.
  [[nodiscard]] Result<bool> Run(const StopToken& stop);

 private:
  TaskSession(const TaskOptions& options, std::filesystem::path program_folder, const Clock& clock,
              Say say, study::StudyFolder folder, launcher::DomainLease domain);

  Result<void> ReadFinished();
  Result<Maze> MakeMaze(int number) const;
  /// Errors: as Run(). False when it was interrupted.
  Result<bool> Play(const Maze& maze, const StopToken& stop);
  void Opened(const Maze& maze, const std::string& url);
  Result<void> WriteReport() const;

  TaskOptions options_;
  std::filesystem::path program_folder_;
  const Clock& clock_;
  Say say_;
  study::StudyFolder folder_;
  launcher::DomainLease domain_;
  std::vector<MazeResult> results_;
  int port_;
};

}  // namespace conav::mapping_task
