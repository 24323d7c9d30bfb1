#pragma once

#include <segments.pb.h>

#include "common/runtime/result.h"
#include "common/segments/segment.h"

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
