#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <vector>

#include "common/bus/publisher.h"
#include "common/bus/subscriber.h"
#include "common/msg/convert.h"
#include "common/runtime/clock.h"
#include "common/runtime/log.h"

namespace conav {

/// Publishes the states of one robot: all that it is given while somebody asks for the full rate
/// (bus::Demand), else news at once and others when they are due. News is what a decision or a person
/// may wait for; a robot that only moves has none until its next place. Threads: one caller.
class RobotStatePublisher {
 public:
  static constexpr std::chrono::milliseconds kPeriod{500};  // of the robot's time
  static constexpr std::chrono::seconds kHeartbeat{1};      // of wall time

  RobotStatePublisher(bus::Participant& participant, const std::string& robot)
      : publisher_(participant, bus::kRobotState, robot) {}

  static bool IsNews(const RobotState& state, const std::optional<RobotState>& before) {
    return !before || state.command_sequence_number != before->command_sequence_number ||
           state.lease_epoch != before->lease_epoch ||
           state.command_outcome != before->command_outcome ||
           state.command_detail != before->command_detail ||
           state.drive_order != before->drive_order || state.stopped != before->stopped ||
           state.stop_revision != before->stop_revision || state.map_stamp != before->map_stamp ||
           state.goals_stamp != before->goals_stamp || state.snapshots != before->snapshots ||
           state.path != before->path;
  }

  bool IsDue(SimTime stamp, Clock::TimePoint now) const {
    return !sent_ || now - sent_at_ >= kHeartbeat || stamp >= sent_->stamp + kPeriod ||
           stamp < sent_->stamp;
  }

  /// False if it is left out.
  bool Publish(RobotState state, Clock::TimePoint now) {
    const bool counts = IsDue(state.stamp, now) || IsNews(state, sent_);
    if (!counts && publisher_.demanding_subscribers() == 0) return false;
    bus::Send(publisher_, ToMessage(state));
    sent_ = std::move(state);
    sent_at_ = now;
    return true;
  }

  /// The next state is due.
  void Restart() { sent_.reset(); }
  /// The newest state published.
  const std::optional<RobotState>& sent() const { return sent_; }

 private:
  bus::Publisher<conav_msgs::msg::RobotState> publisher_;
  std::optional<RobotState> sent_;
  Clock::TimePoint sent_at_{};
};

/// The states of one robot with its goals, from /<robot>/state and /<robot>/goals.
///
/// Stale input: a state waits for the goals that belong to it; a robot that keeps no goals (in the
/// field) has none until the operator service publishes some. A state whose stamp is more than an
/// hour ahead of the newest is left out and logged, since nothing that follows would count; if it
/// says the truth, it is taken once no other has come for 3 s. Threads: one caller.
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
      if (Jumps(state)) continue;
      source_ = state.source;
      stamp_ = state.value.stamp;
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
  static constexpr double kLongestStep = 3600.0;  // s
  static constexpr std::chrono::seconds kPatience{3};

  bool Jumps(const bus::Stamped<RobotState>& state) {
    const bool ahead = stamp_ && state.value.stamp.ToSeconds() > stamp_->ToSeconds() + kLongestStep;
    if (!ahead || state.source > source_ + kPatience) return false;
    if (jumps_logged_.Allow()) {
      LOG_WARNING("state left out, its stamp is far ahead", "robot", state.value.robot, "stamp",
                  state.value.stamp.ToSeconds(), "newest", stamp_->ToSeconds());
    }
    return true;
  }

  bus::Subscriber<conav_msgs::msg::RobotState> states_;
  bus::Subscriber<conav_msgs::msg::RobotGoals> goals_;
  GoalsJoin join_;
  bus::SourceTime source_{};  // of the newest state; likewise:
  std::optional<SimTime> stamp_;
  LogLimit jumps_logged_;
};

}  // namespace conav
