#include "operator/world_topics.h"

#include <fmt/core.h>

#include <utility>

#include "common/grid/map_accuracy.h"
#include "common/msg/convert.h"

namespace conav::operators {

WorldTopics::WorldTopics(bus::Participant& participant, const std::string& name)
    : name(name), participant_(participant), initial_map_(participant, bus::kInitialMap, name) {}

const MapUpdate* WorldTopics::TakeInitialMap() {
  auto maps = initial_map_.TakeValid(kToDomain);
  if (!maps.empty()) pending_ = std::move(maps.back());
  return pending_ ? &*pending_ : nullptr;
}

void WorldTopics::Serve() {
  refusal_.clear();
  grid_ = pending_->geometry();
  initial_ = ToBelief(pending_->cells);
  pending_.reset();
  if (served()) return;
  belief_.emplace(participant_, bus::kBelief, bus::kBeliefChanges, name);
  belief_map_.emplace(participant_, bus::kBeliefMap, name);
}

void WorldTopics::Refuse(std::string reason) {
  refusal_ = std::move(reason);
  pending_.reset();
  belief_.reset();
  belief_map_.reset();
}

void WorldTopics::Publish(const Belief& belief) {
  if (!served()) return;
  belief_->Send(ToMessage(belief));
  bus::Send(*belief_map_, ToOccupancyMessage(belief));
}

std::string WorldTopics::CheckAligned(const std::string& robot, const GridGeometry& map) const {
  if (!served() || AreAligned(map, grid_)) return "";
  return fmt::format("the map of {} has {}, that of world {} has {}", robot, Describe(map), name,
                     Describe(grid_));
}

}  // namespace conav::operators
