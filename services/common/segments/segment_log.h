#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <utility>

#include "common/runtime/result.h"
#include "common/segments/frame_log.h"
#include "common/segments/segment.h"

namespace conav {

/// A segment file that grows while a session runs: a FrameLog, each segment a frame of its own.
/// ReadSegmentFile reads it at any time.
///
/// Threads: not synchronised; one owner. Calls block on the disk.
class SegmentLog {
 public:
  /// Makes the file, or goes on after the trajectories that it has. A last frame that a kill cut off
  /// is moved to the end of `<path>.torn`, which is logged. Its folder must exist.
  /// Errors, with the path; then the file stays as it is: kIo; kUnavailable (another process records
  /// to it); kMalformed (it is no segment file, it is damaged, or none of its frames is complete).
  [[nodiscard]] static Result<SegmentLog> Open(const std::filesystem::path& path);

  /// Number for the next new trajectory.
  std::uint32_t trajectories() const { return trajectories_; }

  /// Appends `segment` and what is now known of its trajectory, whose own `segments` are not looked
  /// at. `number` is one that was used before or trajectories() (demanded).
  /// Errors: kMalformed (CheckTrajectoryFacts, CheckSegment, CheckNextSegment); kIo with path and
  /// cause. Then the file is as it was.
  [[nodiscard]] Result<void> Append(std::uint32_t number, const Trajectory& trajectory,
                                    const Segment& segment);

 private:
  explicit SegmentLog(FrameLog log) : log_(std::move(log)) {}

  FrameLog log_;
  std::uint32_t trajectories_ = 0;
  std::map<std::uint32_t, Segment> newest_;  // of each trajectory that was appended to here
};

}  // namespace conav
