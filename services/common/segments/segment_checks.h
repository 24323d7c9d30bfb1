#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "common/runtime/result.h"
#include "common/segments/segment.h"

/// What a segment must be, whichever way it came: a file, JSON lines, a recording, a synthesis.
/// Errors: kMalformed; the text names the thing, the value and the limit.
namespace conav {

/// The shortest side of a map: a cell inside of the border.
inline constexpr int kMinMapSide = 3;
/// The longest side of a map; larger ones are taken for damage.
inline constexpr int kMaxMapSide = 1024;

/// Refused: maps that are smaller than 3 x 3, too large or of two shapes; values other than 0 and 1
/// (NaN too); x' that differs from x on the border; a path that is empty, leaves the map or does
/// not end in the camera's cell; seen cells outside of the map, not sorted row-major, repeated, or
/// both free and wall; a heading that is no number; times that are negative, not finite or out of
/// order; a picture's file that is absolute or climbs out of the data set, a checksum that is no
/// SHA-256.
[[nodiscard]] Result<void> CheckSegment(const Segment& segment);

/// Everything but the segments: accuracies outside of [0, 1], annotator's parameters that are not
/// finite, names that are not UTF-8, a truth too small or too large.
[[nodiscard]] Result<void> CheckTrajectoryFacts(const Trajectory& trajectory);

/// How `segment` continues its trajectory: its step above that of the segment `before` (null for the
/// first), its maps of the same shape and of the truth's.
[[nodiscard]] Result<void> CheckNextSegment(const std::optional<OccupancyGrid>& truth,
                                            const Segment* before, const Segment& segment);

/// All of the above for each trajectory and segment, and at least one segment in each; errors begin
/// with "trajectory 3, segment 14: " (from 0).
[[nodiscard]] Result<void> CheckSegments(const SegmentSet& set);

/// "trajectory 3, segment 14", as errors name a place.
std::string SegmentPlace(std::size_t trajectory, std::size_t segment);

}  // namespace conav
