#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>

#include "common/runtime/result.h"
#include "common/segments/segment.h"

namespace conav {

/// A segment file that grows while a session runs: each segment is a zstd frame of its own, handed
/// to the operating system before Append() returns, so that it outlives a kill of this process (not
/// a loss of power). ReadSegmentFile reads it at any time.
///
/// Threads: not synchronised; one owner. Calls block on the disk.
class SegmentLog {
 public:
  /// Makes the file, or goes on after the trajectories that it has. A last frame that a kill cut off
  /// is moved to the end of `<path>.torn`, which is logged. Its folder must exist.
  /// Errors, with the path; then the file stays as it is: kIo; kUnavailable (another process records
  /// to it); kMalformed (it is no segment file, it is damaged, or none of its frames is complete).
  [[nodiscard]] static Result<SegmentLog> Open(const std::filesystem::path& path);

  SegmentLog(SegmentLog&& other) noexcept;
  SegmentLog& operator=(SegmentLog&&) = delete;
  ~SegmentLog();

  /// Number for the next new trajectory.
  std::uint32_t trajectories() const { return trajectories_; }

  /// Appends `segment` and what is now known of its trajectory, whose own `segments` are not looked
  /// at. `number` is one that was used before or trajectories() (demanded).
  /// Errors: kMalformed (CheckTrajectoryFacts, CheckSegment, CheckNextSegment); kIo with path and
  /// cause. Then the file is as it was.
  [[nodiscard]] Result<void> Append(std::uint32_t number, const Trajectory& trajectory,
                                    const Segment& segment);

 private:
  SegmentLog(std::filesystem::path path, int file);
  Result<void> Begin();
  Result<void> SetAside(std::string_view torn_end);
  Result<void> Write(const std::string& bytes);
  Error Failure(const std::string& what) const;

  std::filesystem::path path_;
  int file_ = -1;
  std::uint64_t size_ = 0;
  std::uint32_t trajectories_ = 0;
  std::map<std::uint32_t, Segment> newest_;  // of each trajectory that was appended to here
};

}  // namespace conav
