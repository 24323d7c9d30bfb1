#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <utility>

#include "common/runtime/result.h"
#include "common/segments/segment.h"

namespace conav {

/// A file that grows by whole zstd frames during a session. Append() hands each frame to the
/// operating system before it returns, so that it survives a kill of this process (not a loss of
/// power).
///
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

  FrameLog(FrameLog&& other) noexcept;
  FrameLog& operator=(FrameLog&&) = delete;
  ~FrameLog();

  const std::filesystem::path& path() const { return path_; }
  bool empty() const { return size_ == 0; }

  /// Errors: kIo with path and cause; then the file stays as it was.
  [[nodiscard]] Result<void> Append(std::string_view frame);

 private:
  FrameLog(std::filesystem::path path, int file);
  Result<void> Begin(const Check& check);
  Result<void> SetAside(std::string_view torn_end);
  Error Failure(const std::string& what) const;

  std::filesystem::path path_;
  int file_ = -1;
  std::uint64_t size_ = 0;
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
