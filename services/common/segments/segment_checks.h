#pragma once

#include <fmt/core.h>

#include <cstddef>
#include <optional>
#include <string>
#include <utility>

#include "common/runtime/result.h"
#include "common/segments/segment.h"

/// The rules for segments from any source: a file, JSON lines, a recording, a synthesis. Errors:
/// kMalformed; the text names the thing, the value and the limit.
namespace conav {

/// The shortest side of a map: one cell inside the border.
inline constexpr int kMinMapSide = 3;
/// The longest side of a map; a larger one counts as damage.
inline constexpr int kMaxMapSide = 1024;

template <class... Values>
tl::unexpected<Error> Malformed(fmt::format_string<Values...> text, Values&&... values) {
  return Fail(ErrorCode::kMalformed, fmt::format(text, std::forward<Values>(values)...));
}

/// Rejects: maps smaller than 3 x 3, too large or of two shapes; values other than 0 and 1 (NaN
/// too); x' that differs from x on the border; a path that is empty, leaves the map or
/// does not end in the camera's cell; seen cells outside the map, not sorted row-major,
/// repeated, or both free and wall; a heading that is NaN; times that are negative, not
/// finite or out of order; an image path that is absolute or leaves the data set; a
/// checksum that is not a SHA-256.
[[nodiscard]] Result<void> CheckSegment(const Segment& segment);

/// Checks everything except the segments. Rejects accuracies outside of [0, 1], annotator
/// parameters that are not finite, names that are not UTF-8, a truth that is too small or too
/// large.
[[nodiscard]] Result<void> CheckTrajectoryFacts(const Trajectory& trajectory);

/// Checks that `segment` continues its trajectory: its step is above that of the segment `before`
/// (null for the first), its maps have the same shape as before and as the truth.
[[nodiscard]] Result<void> CheckNextSegment(const std::optional<OccupancyGrid>& truth,
                                            const Segment* before, const Segment& segment);

/// All of the above for each trajectory and segment, and at least one segment per trajectory.
/// Errors begin with "trajectory 3, segment 14: " (from 0).
[[nodiscard]] Result<void> CheckSegments(const SegmentSet& set);

/// "trajectory 3, segment 14": the place in error messages.
std::string SegmentPlace(std::size_t trajectory, std::size_t segment);

}  // namespace conav
