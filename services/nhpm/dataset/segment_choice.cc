#include <fmt/format.h>

#include <algorithm>
#include <iterator>

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

/// Up to `count` of `all`, evenly spread.
std::vector<ChosenSegment> Spread(const std::vector<ChosenSegment>& all, std::size_t count) {
  std::vector<ChosenSegment> chosen;
  const std::size_t taken = std::min(count, all.size());
  for (std::size_t i = 0; i < taken; ++i) chosen.push_back(all[i * all.size() / taken]);
  return chosen;
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
  std::vector<ChosenSegment> edited = All(set);
  const auto others = std::ranges::stable_partition(
      edited, [](const ChosenSegment& one) { return EditCount(*one.segment) > 0; });
  const std::vector<ChosenSegment> unedited(others.begin(), others.end());
  edited.erase(others.begin(), others.end());
  std::vector<ChosenSegment> chosen = Spread(edited, count);
  std::ranges::copy(Spread(unedited, count - chosen.size()), std::back_inserter(chosen));
  std::ranges::sort(chosen, {}, &ChosenSegment::index);
  return chosen;
}

}  // namespace conav::nhpm
