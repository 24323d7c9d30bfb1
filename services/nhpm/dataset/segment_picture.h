#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "common/runtime/result.h"
#include "common/segments/segment.h"

/// A few segments for the eye: the map before with path and camera, what the picture shows, the map
/// after with its edits.
namespace conav::nhpm {

/// A segment and where it is from.
struct ChosenSegment {
  std::size_t index = 0;  // in the set, over all trajectories
  std::size_t trajectory = 0;
  const Segment* segment = nullptr;
  SegmentOrigin origin = SegmentOrigin::kPerson;
};

/// The segments with these indices. Errors: kOutOfRange names index and limit.
[[nodiscard]] Result<std::vector<ChosenSegment>> ChooseSegments(
    const SegmentSet& set, std::span<const std::size_t> indices);

/// Up to `count` segments with edits, spread over the set; where those do not suffice all of them and
/// others, likewise spread. In the order of the set.
std::vector<ChosenSegment> ChooseSegments(const SegmentSet& set, std::size_t count);

/// An SVG document, one row for each segment; says in each row who made the edits.
std::string SegmentsSvg(std::span<const ChosenSegment> chosen, std::string_view title);

/// The same in characters:
///   #  wall       before: o path, > ^ < v camera       shown: . seen free, # seen wall
///                 after:  + wall added, - wall removed
std::string SegmentText(const ChosenSegment& chosen);

}  // namespace conav::nhpm
