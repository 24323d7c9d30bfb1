#pragma once

#include <functional>
#include <map>
#include <span>
#include <string>

#include "operator/timeline/timeline_builder.h"

namespace conav::operators {

/// Takes up a serialised message that was recorded at `wall_s`; false when it is not one of the
/// topic's, or says what cannot be.
using TakeUp = std::function<bool(std::span<const std::uint8_t> message, double wall_s)>;

/// For each topic that a console hears of these robots (their worlds by name), by topic. `builder`
/// outlives it.
std::map<std::string, TakeUp> RecordedTopics(
    const std::map<std::string, std::string>& world_of_robot, TimelineBuilder& builder);

}  // namespace conav::operators
