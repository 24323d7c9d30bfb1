#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <mutex>

#include "common/runtime/log_limit.h"
#include "planner/decision/method.h"
#include "planner/record/decision_log.h"

namespace conav::planner {

/// Records the decisions of a planner's robots for `conav explain`. One that cannot be written is
/// lost, logged and counted; the robots go on.
/// Threads: any.
class DecisionRecording {
 public:
  /// Throws StartupError: the file cannot be recorded to.
  explicit DecisionRecording(const std::filesystem::path& file);

  /// `decision` commands the robot and its report is complete. Blocks on the disk.
  void Record(const Decision& decision, const Situation& situation);

  std::uint64_t recorded() const { return recorded_; }
  std::uint64_t lost() const { return lost_; }

 private:
  std::mutex mutex_;  // guards log_
  DecisionLog log_;
  std::atomic<std::uint64_t> recorded_ = 0;
  std::atomic<std::uint64_t> lost_ = 0;
  LogLimit failures_logged_;
};

}  // namespace conav::planner
