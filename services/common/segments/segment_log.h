#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <utility>

#include "common/runtime/file.h"
#include "common/runtime/result.h"
#include "common/segments/segment.h"

namespace conav {

/// An AppendedFile whose blocks are zstd frames, and which may go on in a later session.
/// Threads: not synchronised; one owner. Calls block on the disk.
class FrameLog {
 public:
  /// Inspects the file's complete frames; not called for a new file.
  using Check = std::function<Result<void>(std::string_view frames)>;

  /// Creates the file, or continues after its last complete frame. Moves a torn last frame to the
  /// end of `<path>.torn` and logs it. Its folder must exist.
  /// Errors, with the path; then the file stays as it is: kIo; kUnavailable (another process
  /// records to it); kMalformed (not zstd, damaged, no complete frame); those of `check`.
  [[nodiscard]] static Result<FrameLog> Open(const std::filesystem::path& path, const Check& check);

  bool empty() const { return file_.size() == 0; }

  /// Errors: kIo with path and cause; then the file stays as it was.
  [[nodiscard]] Result<void> Append(std::string_view frame) { return file_.Append(frame); }

 private:
  explicit FrameLog(AppendedFile file) : file_(std::move(file)) {}
  Result<void> Begin(const Check& check);
  Result<void> SetAside(std::string_view torn_end) const;

  AppendedFile file_;
};

/// A segment file that grows during a session: a FrameLog with one frame per segment.
/// ReadSegmentFile can read it at any time.
///
/// Threads: not synchronised; one owner. Calls block on the disk.
class SegmentLog {
 public:
  /// Creates the file, or continues after its trajectories. Moves a torn last frame to the end of
  /// `<path>.torn` and logs it. Its folder must exist.
  /// Errors, with the path; then the file stays as it is: kIo; kUnavailable (another process
  /// records to it); kMalformed (no segment file, damaged, or no complete frame).
  [[nodiscard]] static Result<SegmentLog> Open(const std::filesystem::path& path);

  /// The number for the next new trajectory.
  std::uint32_t trajectories() const { return trajectories_; }

  /// Appends `segment` and the current facts of its trajectory, ignoring the trajectory's own
  /// `segments`. `number` is an earlier one or trajectories() (demanded).
  /// Errors: kMalformed (CheckTrajectoryFacts, CheckSegment, CheckNextSegment); kIo with path and
  ///         cause. Then the file stays as it was.
  [[nodiscard]] Result<void> Append(std::uint32_t number, const Trajectory& trajectory,
                                    const Segment& segment);

 private:
  explicit SegmentLog(FrameLog log) : log_(std::move(log)) {}

  FrameLog log_;
  std::uint32_t trajectories_ = 0;
  std::map<std::uint32_t, Segment> newest_;  // of each trajectory appended to here
};

}  // namespace conav
