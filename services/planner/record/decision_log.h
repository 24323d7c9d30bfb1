#pragma once

#include <filesystem>

#include "common/segments/frame_log.h"
#include "planner/record/decision_record.h"

namespace conav::planner {

/// A file of decisions (idl/decisions.proto) that grows while a planner runs: a FrameLog, each
/// decision a frame of its own. A decision takes about 2 kB, several with a whole tree.
class DecisionLog {
 public:
  /// Goes on after what the file has. Errors: as FrameLog::Open(); kMalformed also for a file of
  /// something else.
  [[nodiscard]] static Result<DecisionLog> Open(const std::filesystem::path& path);

  /// Errors: kIo; then the file is as it was.
  [[nodiscard]] Result<void> Append(const DecisionRecord& decision);

 private:
  explicit DecisionLog(FrameLog log) : log_(std::move(log)) {}

  FrameLog log_;
};

}  // namespace conav::planner
