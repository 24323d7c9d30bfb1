#pragma once

#include <filesystem>
#include <string>

#include "common/runtime/result.h"
#include "common/segments/segment.h"

namespace conav::segments {
class Record;
class Segment;
class Trajectory;
}  // namespace conav::segments

/// Between domain values and the records of idl/segments.proto, which go no further.
namespace conav {

inline constexpr std::uint32_t kSegmentSchemaVersion = 1;

segments::Record HeaderRecord();
/// Without its segments. Requires CheckTrajectoryFacts.
segments::Record ToRecord(const Trajectory& trajectory, std::uint32_t number);
/// Requires CheckSegment.
segments::Record ToRecord(const Segment& segment, std::uint32_t trajectory);

/// Errors: kMalformed: an origin, a map's size or value, or a cell that no segment can have. What
/// goes beyond the shape of the record is left to CheckSegments.
[[nodiscard]] Result<Trajectory> ToDomain(const segments::Trajectory& record);
[[nodiscard]] Result<Segment> ToDomain(const segments::Segment& record);

}  // namespace conav

/// Files of segments: length-delimited records of idl/segments.proto, compressed with zstd.
namespace conav {

/// Writes one zstd frame beside `path` and renames it, so that a reader sees the old file or the
/// new one; a device or a pipe is written to as it is.
/// Errors: kMalformed (CheckSegments); kIo with path and cause (a full disk, no such folder); then
/// `path` is as it was.
[[nodiscard]] Result<void> WriteSegmentFile(const std::filesystem::path& path,
                                            const SegmentSet& set);

/// What becomes of a file that ends inside of a frame, as a recording does whose writer was killed.
enum class TornEnd {
  kRefuse,
  kDrop,  // the complete frames before it count
};

/// Reads what WriteSegmentFile or SegmentLog wrote, several frames in a row as well. Memory is taken
/// as records arrive, never for what a header promises.
/// Errors, each with path, and trajectory and segment where there is one: kNotFound; kIo; kMalformed
/// (empty, no zstd, truncated, damaged, no segment file, another schema version, CheckSegments).
[[nodiscard]] Result<SegmentSet> ReadSegmentFile(const std::filesystem::path& path,
                                                 TornEnd torn_end = TornEnd::kRefuse);

struct IdentifiedSegments {
  SegmentSet set;
  std::string checksum;  // SHA-256 of the bytes that `set` was read from
};

/// As ReadSegmentFile.
[[nodiscard]] Result<IdentifiedSegments> ReadIdentifiedSegments(const std::filesystem::path& path);

}  // namespace conav
