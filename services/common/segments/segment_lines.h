#pragma once

#include <nlohmann/json.hpp>

#include "common/segments/json_fields.h"
#include "common/segments/segment.h"

/// One JSON line of segment_json.h <-> one value.
namespace conav {

nlohmann::ordered_json ToLine(const Trajectory& trajectory);
nlohmann::ordered_json ToLine(const Segment& segment);

/// What a trajectory's line says of its segments.
struct TrajectoryLine {
  Trajectory trajectory;  // without segments
  int rows = 0;
  int columns = 0;
  std::optional<std::uint64_t> edits;
};

/// Throw LineRefused.
TrajectoryLine ToTrajectory(JsonFields& line);
Segment ToSegment(JsonFields& line, int rows, int columns);

/// Cells that were edited in all segments.
std::uint64_t EditCount(const Trajectory& trajectory);

}  // namespace conav
