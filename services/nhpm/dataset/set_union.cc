#include "nhpm/dataset/set_union.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

namespace conav::nhpm {

Result<void> SetUnion::Add(SegmentSet set, const std::string& name) {
  std::vector<std::string> places;
  for (std::size_t i = 0; i < set.trajectories.size(); ++i) {
    places.push_back(fmt::format("{}: trajectory {}", name, i));
    const auto same = std::ranges::find(all_.trajectories, set.trajectories[i]);
    if (same == all_.trajectories.end()) continue;
    const auto index = static_cast<std::size_t>(same - all_.trajectories.begin());
    return Fail(ErrorCode::kRefused,
                fmt::format("{} is the same as {}", places.back(), places_[index]));
  }
  std::ranges::move(set.trajectories, std::back_inserter(all_.trajectories));
  std::ranges::move(places, std::back_inserter(places_));
  return {};
}

}  // namespace conav::nhpm
