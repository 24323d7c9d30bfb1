#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/bus/subscriber.h"
#include "common/msg/convert.h"

namespace conav {

/// The states of one robot with its goals, from /<robot>/state and /<robot>/goals.
///
/// Stale input: a state waits for the goals that belong to it; a robot that keeps no goals (in the
/// field) has none until the operator service publishes some. Threads: one caller.
class RobotStateTopics {
 public:
  RobotStateTopics(bus::Participant& participant, const std::string& robot)
      : states_(participant, bus::kRobotState, robot),
        goals_(participant, bus::kRobotGoals, robot) {}

  /// The valid states since the last call; the newest one again when its goals changed.
  std::vector<bus::Stamped<RobotState>> TakeStamped() {
    std::vector<bus::Stamped<RobotState>> joined;
    const auto add = [&](std::optional<RobotState> state) {
      if (state) joined.push_back({*std::move(state), source_});
    };
    for (auto& state : states_.TakeValidStamped(kToDomain)) {
      source_ = state.source;
      add(join_.Receive(std::move(state.value)));
    }
    for (RobotGoals& goals : goals_.TakeValid(kToDomain)) add(join_.Receive(std::move(goals)));
    return joined;
  }

  /// Robots that publish a state: 0 or 1.
  int matched_publishers() const { return states_.matched_publishers(); }
  /// Programs that publish its goals: more than 1 contradict each other.
  int goal_publishers() const { return goals_.matched_publishers(); }

 private:
  bus::Subscriber<conav_msgs::msg::RobotState> states_;
  bus::Subscriber<conav_msgs::msg::RobotGoals> goals_;
  GoalsJoin join_;
  bus::SourceTime source_{};  // of the newest state
};

}  // namespace conav
