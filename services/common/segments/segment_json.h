#pragma once

#include <filesystem>
#include <iosfwd>
#include <string>

#include "common/runtime/result.h"
#include "common/segments/segment.h"

/// Segments as JSON lines, for people who work in Python. One line for a trajectory, then one for
/// each of its segments:
///
///   {"type": "trajectory", "schema": 1, "origin": "person", "participant": "p07", "session":
///   "...",
///    "world": "conav13", "world_seed": 7, "corruption_seed": 7, "rows": 15, "columns": 15,
///    "truth": "1110..." or null, "initial_cell_accuracy": 0.88, "final_cell_accuracy": 0.96,
///    "final_mapping_accuracy": 0.7, "valid": true, "edits": 17, "annotator": {}, "annotator_seed":
///    0}
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
