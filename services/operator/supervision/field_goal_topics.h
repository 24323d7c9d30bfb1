#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/bus/participant.h"
#include "common/bus/publisher.h"
#include "common/bus/subscriber.h"
#include "common/msg/supervision.h"
#include "common/runtime/clock.h"
#include "common/runtime/log.h"
#include "common/service/diagnostics.h"
#include "operator/belief/belief_store.h"
#include "operator/config.h"
#include "operator/supervision/field_goals.h"
#include "operator/supervision/supervision_topics.h"

// One user: the operator service; why it is apart: it is idle unless `goals.robots` names robots.

namespace conav::operators {

/// The goals of the robots of `goals.robots` on the bus (FieldGoals): on disk first, then published;
/// and whether any robot's goals have two writers.
///
/// Publishes a robot's goals from its first report on, which says that it does not keep them itself,
/// as long as no other program published some before. A goal pose replaces what a robot has left.
/// Threads: one, the service's.
class FieldGoalTopics {
 public:
  /// All outlive it. Throws StartupError: `goals.robots` names a robot that is not supervised here, or
  /// the mission cannot be used.
  FieldGoalTopics(bus::Participant& participant, const OperatorConfig& config, BeliefStore& store,
                  const Clock& clock);

  static bool Handles(const OperatorRequest& request) {
    return std::holds_alternative<GoalsRequest>(request.body);
  }
  /// Requires Handles(request), and that it is no repeat.
  BeliefStore::Answer Answer(const OperatorRequest& request);

  /// `publishers`: how many programs publish the robot's goals, this one included.
  void Receive(const RobotState& state, int publishers);
  void CountPublishers(const std::string& robot, int publishers);
  /// Takes goal poses. Another client's control of the robot refuses them. Those of a robot in the
  /// field that `goals.robots` does not name are ignored with a warning.
  void Step(const ControlRegistry& control);

  /// What is wrong with the robot's goals, for people; empty = nothing.
  std::string ProblemOf(const std::string& robot) const;
  /// "r1/goals_left".
  void AddTo(Health& health) const;

 private:
  struct Link {
    std::unique_ptr<bus::Publisher<conav_msgs::msg::RobotGoals>> goals;
    std::unique_ptr<bus::Subscriber<geometry_msgs::msg::PoseStamped>> goal_pose;
    bool in_field = false;  // its newest report says that it does not keep its goals itself
    LogLimit ignored{std::chrono::seconds(10)};
    bool others_publish = false;
    Clock::TimePoint others_since{};
    std::string logged;  // problem
  };

  void WarnOfIgnored(const std::string& robot);
  void TakeGoalPose(const std::string& robot, Position goal, const ControlRegistry& control);
  void Publish(const KeptGoals& kept);
  void LogProblem(const std::string& robot);

  bus::Participant& participant_;
  BeliefStore& store_;
  const Clock& clock_;
  FieldGoals goals_;
  std::map<std::string, Link> links_;  // all supervised robots
};

}  // namespace conav::operators
