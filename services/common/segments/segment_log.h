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

/// A file that grows by whole zstd frames while a session runs: each is handed to the operating system
/// before Append() returns, so that it outlives a kill of this process (not a loss of power).
///
/// Threads: not synchronised; one owner. Calls block on the disk.
class FrameLog {
 public:
  /// Looks at what the file has so far, complete frames only; not called for a new file.
  using Check = std::function<Result<void>(std::string_view frames)>;

  /// Makes the file, or goes on after the frames that it has. A last frame that a kill cut off is
  /// moved to the end of `<path>.torn`, which is logged. Its folder must exist.
  /// Errors, with the path; then the file stays as it is: kIo; kUnavailable (another process records
  /// to it); kMalformed (no zstd, damaged, none of its frames is complete); those of `check`.
  [[nodiscard]] static Result<FrameLog> Open(const std::filesystem::path& path, const Check& check);

  FrameLog(FrameLog&& other) noexcept;
  FrameLog& operator=(FrameLog&&) = delete;
  ~FrameLog();

  const std::filesystem::path& path() const { return path_; }
  bool empty() const { return size_ == 0; }

  /// Errors: kIo with path and cause; then the file is as it was.
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
