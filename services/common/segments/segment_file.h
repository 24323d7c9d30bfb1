#pragma once

#include <filesystem>
#include <iosfwd>
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

/// Segments as JSON lines, for people who work in Python. One line for a trajectory, then one for
/// each of its segments:
///
///   {"type": "trajectory", "schema": 1, "origin": "person", "participant": "p07",
///    "session": "...", "world": "conav13", "world_seed": 7, "corruption_seed": 7, "rows": 15,
///    "columns": 15, "truth": "1110..." or null, "initial_cell_accuracy": 0.88,
///    "final_cell_accuracy": 0.96, "final_mapping_accuracy": 0.7, "valid": true, "edits": 17,
///    "annotator": {}, "annotator_seed": 0}
///   {"type": "segment", "step": 0, "x": "1110...", "tau": [[1, 1], [1, 2]],
///    "pose": {"r": 1, "c": 2, "heading_deg": 90.0}, "o_free": "0110...", "o_wall": "1001...",
///    "x_next": "1110...", "image": "", "image_sha256": "", "sent_s": 3.5, "first_edit_s": null,
///    "confirmed_s": 9.25, "goals_reached": 1}
///
/// Bit strings are row-major from the northern row, 1 = wall (seen, for o_free and o_wall); in
/// `truth` a `?` is unknown. Headings: 0 = east, counter-clockwise. If the degrees do not give the
/// exact number, "heading_rad" accompanies "heading_deg" and takes precedence. `valid` (final
/// mapping accuracy above 0.5) and `edits` follow from the rest: they are optional, and rejected if
/// they contradict it. Without a truth the accuracies may be null or missing, and are 0. Source:
/// paper Appendix A, (x, tau, o, x').
namespace conav {

/// All lines. Importing them gives the same set back. Requires CheckSegments(set).
void ExportSegments(const SegmentSet& set, std::ostream& out);

/// Reads the lines of `in` and skips empty ones. Errors: kMalformed with "name:line: " and reason
/// (not JSON, an unknown or missing key or one of a wrong type, a segment before any trajectory,
/// another schema, a bit string of another length, CheckSegments).
[[nodiscard]] Result<SegmentSet> ImportSegments(std::istream& in, const std::string& name);

/// The same for a file. Errors also: kNotFound, kIo.
[[nodiscard]] Result<SegmentSet> ImportSegmentsFile(const std::filesystem::path& path);

/// Writes as WriteFile does. Errors: kMalformed (CheckSegments), kIo.
[[nodiscard]] Result<void> ExportSegmentsFile(const std::filesystem::path& path,
                                              const SegmentSet& set);

}  // namespace conav
