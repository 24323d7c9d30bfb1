#include <fmt/format.h>

#include <algorithm>

#include "common/segments/segment_labels.h"
#include "nhpm/dataset/segment_picture.h"

namespace conav::nhpm {
namespace {

std::vector<ChosenSegment> All(const SegmentSet& set) {
  std::vector<ChosenSegment> all;
  for (std::size_t t = 0; t < set.trajectories.size(); ++t) {
    for (const Segment& segment : set.trajectories[t].segments) {
      all.push_back({all.size(), t, &segment, set.trajectories[t].origin});
    }
  }
  return all;
}

}  // namespace

Result<std::vector<ChosenSegment>> ChooseSegments(const SegmentSet& set,
                                                  std::span<const std::size_t> indices) {
  const std::vector<ChosenSegment> all = All(set);
  std::vector<ChosenSegment> chosen;
  for (const std::size_t index : indices) {
    if (index >= all.size()) {
      return Fail(
          ErrorCode::kOutOfRange,
          fmt::format("there is no segment {}; the set has {}, from 0 on", index, all.size()));
    }
    chosen.push_back(all[index]);
  }
  return chosen;
}

std::vector<ChosenSegment> ChooseSegments(const SegmentSet& set, std::size_t count) {
  std::vector<ChosenSegment> candidates;
  const std::vector<ChosenSegment> all = All(set);
  for (const ChosenSegment& one : all) {
    if (EditCount(*one.segment) > 0) candidates.push_back(one);
  }
  if (candidates.size() < count) candidates = all;
  std::vector<ChosenSegment> chosen;
  for (std::size_t i = 0; i < count && i < candidates.size(); ++i) {
    chosen.push_back(candidates[i * candidates.size() / std::min(count, candidates.size())]);
  }
  return chosen;
}

}  // namespace conav::nhpm
