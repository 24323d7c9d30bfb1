#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "common/segments/segment.h"

namespace conav {

/// What the person did, in the shape of PerceptionAnswer: 1 where the cell was edited.
struct EditLabels {
  Grid<std::uint8_t> add;     // x 0 -> x' 1
  Grid<std::uint8_t> remove;  // x 1 -> x' 0
  bool operator==(const EditLabels&) const = default;
};

/// Labels of a segment that passed CheckSegment.
EditLabels LabelsOf(const Segment& segment);

std::size_t SegmentCount(const SegmentSet& set);

/// All segments, trajectory by trajectory, without copying; valid as long as `set` is not changed.
std::vector<const Segment*> AllSegments(const SegmentSet& set);

/// Their queries, as EditModel::Predict takes them.
std::vector<PerceptionQuery> Queries(const SegmentSet& set);

/// Who made the edits: "people", "simulated", "synthetic", or several joined by "+", in this order;
/// "nobody" for an empty set. What reports and weights files call their data.
std::string OriginText(const SegmentSet& set);

/// "person", "simulated" or "synthetic".
const char* ToText(SegmentOrigin origin);

}  // namespace conav
