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

/// Publishes the states of one robot, and on a topic for links fewer of them with less in each: what an
/// operator waits for at once, the others when they are due. Threads: one caller.
class RobotStatePublisher {
 public:
  static constexpr std::chrono::milliseconds kPeriod{500};  // of the robot's time, over links
  static constexpr std::chrono::seconds kHeartbeat{1};      // of wall time, over links
  static constexpr std::size_t kPlaces = 3;                 // of the path, over links

  RobotStatePublisher(bus::Participant& participant, const std::string& robot)
      : full_(participant, bus::kRobotState, robot),
        throttled_(participant, bus::kThrottledState, robot) {}

  void Publish(RobotState state, Clock::TimePoint now) {
    bus::Send(full_, ToMessage(state));
    if (!IsUrgent(state) && !IsDue(state.stamp, now)) return;
    if (state.path.size() > kPlaces)
      state.path.erase(state.path.begin(), state.path.end() - kPlaces);
    bus::Send(throttled_, ToMessage(state));
    sent_ = std::move(state);
    sent_at_ = now;
  }
  /// The next state is the first of another run.
  void Restart() { sent_.reset(); }

 private:
  bool IsDue(SimTime stamp, Clock::TimePoint now) const {
    return now - sent_at_ >= kHeartbeat || stamp >= sent_->stamp + kPeriod || stamp < sent_->stamp;
  }
  bool IsUrgent(const RobotState& state) const {
    if (!sent_) return true;
    const bool failed = state.command_outcome == CommandOutcome::kBlocked ||
                        state.command_outcome == CommandOutcome::kRefused ||
                        state.command_outcome == CommandOutcome::kExpired;
    return (failed && state.command_outcome != sent_->command_outcome) ||
           state.stopped != sent_->stopped || state.stop_revision != sent_->stop_revision ||
           state.goals_stamp != sent_->goals_stamp || state.snapshots != sent_->snapshots;
  }

  bus::Publisher<conav_msgs::msg::RobotState> full_;
  bus::Publisher<conav_msgs::msg::RobotState> throttled_;
  std::optional<RobotState> sent_;  // over links
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
  enum class Rate { kFull, kThrottledOverLinks };

  /// kThrottledOverLinks: over a link the throttled states, where the robot publishes such.
  RobotStateTopics(bus::Participant& participant, const std::string& robot, Rate rate = Rate::kFull)
      : participant_(participant), robot_(robot), goals_(participant, bus::kRobotGoals, robot) {
    if (rate == Rate::kThrottledOverLinks && participant.over_link()) {
      throttled_.emplace(participant, bus::kThrottledState, robot);
    }
    ChooseTopic();
  }

  /// The valid states since the last call; the newest one again when its goals changed.
  std::vector<bus::Stamped<RobotState>> TakeStamped() {
    std::vector<bus::Stamped<RobotState>> joined;
    const auto add = [&](std::optional<RobotState> state) {
      if (state) joined.push_back({*std::move(state), source_, writer_});
    };
    for (auto* states : {&full_, &throttled_}) {
      if (!*states) continue;
      for (auto& state : (*states)->TakeValidStamped(kToDomain)) {
        // Of the other topic: a late joiner gets what was sent before what it has.
        const bool is_of_other = states != newest_;
        if (is_of_other && stamp_ && state.value.stamp < *stamp_ && state.source < source_)
          continue;
        if (Jumps(state)) continue;
        newest_ = states;
        source_ = state.source;
        writer_ = state.writer;
        stamp_ = state.value.stamp;
        add(join_.Receive(std::move(state.value)));
      }
    }
    ChooseTopic();
    for (RobotGoals& goals : goals_.TakeValid(kToDomain)) add(join_.Receive(std::move(goals)));
    return joined;
  }

  /// Robots that publish a state: 0 or 1.
  int matched_publishers() const { return (full_ ? full_ : throttled_)->matched_publishers(); }
  /// Programs that publish its goals: more than 1 contradict each other.
  int goal_publishers() const { return goals_.matched_publishers(); }

 private:
  static constexpr double kLongestStep = 3600.0;  // s
  static constexpr std::chrono::seconds kPatience{3};

  /// One of the two; robots that others have made publish no throttled states.
  void ChooseTopic() {
    const bool needs_full = !throttled_ || throttled_->matched_publishers() == 0;
    if (needs_full == full_.has_value()) return;
    full_.reset();
    if (needs_full) full_.emplace(participant_, bus::kRobotState, robot_);
  }

  bool Jumps(const bus::Stamped<RobotState>& state) {
    const bool ahead = stamp_ && state.value.stamp.ToSeconds() > stamp_->ToSeconds() + kLongestStep;
    if (!ahead || state.source > source_ + kPatience) return false;
    if (jumps_logged_.Allow()) {
      LOG_WARNING("state left out, its stamp is far ahead", "robot", state.value.robot, "stamp",
                  state.value.stamp.ToSeconds(), "newest", stamp_->ToSeconds());
    }
    return true;
  }

  bus::Participant& participant_;
  const std::string robot_;
  std::optional<bus::Subscriber<conav_msgs::msg::RobotState>> full_;
  std::optional<bus::Subscriber<conav_msgs::msg::RobotState>> throttled_;
  bus::Subscriber<conav_msgs::msg::RobotGoals> goals_;
  GoalsJoin join_;
  const void* newest_ = nullptr;  // the topic of the newest state
  bus::SourceTime source_{};      // of the newest state; likewise:
  bus::Guid writer_{};
  std::optional<SimTime> stamp_;
  LogLimit jumps_logged_;
};

}  // namespace conav
