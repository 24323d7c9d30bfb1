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

/// Files of segments: length-delimited records of idl/segments.proto, compressed with zstd. The
/// records stop here; the rest of conav uses the domain values.
namespace conav {

inline constexpr std::uint32_t kSegmentSchemaVersion = 1;

segments::Record HeaderRecord();
/// Without its segments. Requires CheckTrajectoryFacts.
segments::Record ToRecord(const Trajectory& trajectory, std::uint32_t number);
/// Requires CheckSegment.
segments::Record ToRecord(const Segment& segment, std::uint32_t trajectory);

/// Errors: kMalformed: an origin, a map's size or value, or a cell that no segment can have. Leaves
///         the rules beyond the record's own shape to CheckSegments.
[[nodiscard]] Result<Trajectory> ToDomain(const segments::Trajectory& record);
[[nodiscard]] Result<Segment> ToDomain(const segments::Segment& record);

/// Writes one zstd frame to a temporary file next to `path` and renames it, so that a reader sees
/// the old file or the new one; writes a device or pipe in place.
/// Errors: kMalformed (CheckSegments); kIo with path and cause (a full disk, no such folder); then
///         `path` stays as it was.
[[nodiscard]] Result<void> WriteSegmentFile(const std::filesystem::path& path,
                                            const SegmentSet& set);

/// How to read a file that ends inside a frame, as a recording does when its writer was killed.
enum class TornEnd {
  kRefuse,
  kDrop,  // keep the complete frames before it
};

/// Reads files of WriteSegmentFile or SegmentLog, also several frames in a row. Allocates memory as
/// records arrive, never for what a header promises.
/// Errors, each with path, and trajectory and segment if known: kNotFound; kIo; kMalformed (empty,
/// not zstd, truncated, damaged, no segment file, another schema version, CheckSegments).
[[nodiscard]] Result<SegmentSet> ReadSegmentFile(const std::filesystem::path& path,
                                                 TornEnd torn_end = TornEnd::kRefuse);

struct IdentifiedSegments {
  SegmentSet set;
  std::string checksum;  // SHA-256 of the file that `set` came from
};

/// As ReadSegmentFile.
[[nodiscard]] Result<IdentifiedSegments> ReadIdentifiedSegments(const std::filesystem::path& path);

}  // namespace conav
