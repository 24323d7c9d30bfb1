#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "common/runtime/result.h"
#include "common/segments/segment.h"

/// Pictures of a few segments: the map before with path and camera, what the picture shows, the map
/// after with its edits.
namespace conav::nhpm {

/// A segment and its origin.
struct ChosenSegment {
  std::size_t index = 0;  // in the set, over all trajectories
  std::size_t trajectory = 0;
  const Segment* segment = nullptr;
  SegmentOrigin origin = SegmentOrigin::kPerson;
};

/// The segments with these indices. Errors: kOutOfRange names index and limit.
[[nodiscard]] Result<std::vector<ChosenSegment>> ChooseSegments(
    const SegmentSet& set, std::span<const std::size_t> indices);

/// Up to `count` segments with edits, evenly spread over the set; if there are too few, all of them
/// plus others, also spread. In the order of the set.
std::vector<ChosenSegment> ChooseSegments(const SegmentSet& set, std::size_t count);

/// An SVG document, one row for each segment; each row states the origin of the edits.
std::string SegmentsSvg(std::span<const ChosenSegment> chosen, std::string_view title);

/// The same in characters:
///   #  wall       before: o path, > ^ < v camera       shown: . seen free, # seen wall
///                 after:  + wall added, - wall removed
std::string SegmentText(const ChosenSegment& chosen);

}  // namespace conav::nhpm
