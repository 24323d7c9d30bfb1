#include "nhpm/dataset/set_union.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace conav::nhpm {
namespace {

/// The heading counts only through what the camera saw.
bool HaveSameContent(const Segment& a, const Segment& b) {
  return a.query.belief == b.query.belief && a.belief_after == b.belief_after &&
         a.query.path == b.query.path && a.query.cell == b.query.cell &&
         a.query.visible == b.query.visible;
}

bool BeginAlike(const Trajectory& a, const Trajectory& b) {
  const auto both = static_cast<std::ptrdiff_t>(std::min(a.segments.size(), b.segments.size()));
  return std::equal(a.segments.begin(), a.segments.begin() + both, b.segments.begin(),
                    HaveSameContent);
}

}  // namespace

Result<void> SetUnion::Add(SegmentSet set, const std::string& name) {
  for (std::size_t i = 0; i < set.trajectories.size(); ++i) {
    Trajectory& added = set.trajectories[i];
    const std::string place = fmt::format("{}: trajectory {}", name, i);
    const Key key{added.origin,     added.participant,     added.world,
                  added.world_seed, added.corruption_seed, added.annotator_seed};
    const auto [begin, end] = indices_.equal_range(key);
    for (auto entry = begin; entry != end; ++entry) {
      if (!BeginAlike(added, all_.trajectories[entry->second])) continue;
      return Fail(ErrorCode::kRefused,
                  fmt::format("{} is the same as {}", place, places_[entry->second]));
    }
    indices_.emplace(key, all_.trajectories.size());
    all_.trajectories.push_back(std::move(added));
    places_.push_back(place);
  }
  return {};
}

}  // namespace conav::nhpm
