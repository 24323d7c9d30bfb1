#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/bus/action.h"
#include "common/bus/publisher.h"
#include "planner/decision/blackboard.h"

// One user: planner_service.cc.

namespace conav::planner {

/// Lets ROS 2 programs send one robot somewhere, by the actions NavigateToPose and FollowPath, while
/// this process drives it (Lease); otherwise the actions are not offered.
///
/// The goal or path becomes the robot's guidance, and its end the robot's only goal until it is there, so
/// it drives there under its planner: it may look around, send pictures and give way. NavigateToPose for a robot that does not keep its goals (the
/// field) makes it the robot's goal, over goal_pose and the operator service. Ends with succeeded at the
/// last cell; aborted if the goal is refused, the operator draws another path, the guidance ends
/// before, or another process takes the robot over. A newer goal of either action aborts the older one.
/// A robot that is stopped or waits keeps the goal until it may go on. Error codes are those of Nav2.
/// Threads: one, the receiving one.
class RobotActions {
 public:
  /// `board` outlives it and knows the robot.
  RobotActions(bus::Participant& participant, std::string robot, Blackboard& board);
  ~RobotActions() { End(); }
  RobotActions(const RobotActions&) = delete;
  RobotActions& operator=(const RobotActions&) = delete;

  /// Call it often: answers clients and follows the robot.
  void Turn();
  /// Aborts the goal and answers nothing more, until the next Turn().
  void End();

 private:
  using SteadyTime = std::chrono::steady_clock::time_point;

  struct Active {
    bool is_path = false;  // of FollowPath
    bus::GoalId id{};
    std::vector<Position> positions;
    std::uint64_t route = 0;  // 0 = it is the robot's own goal
    bool was_its_goal = false;
    bool was_reached_before = false;  // it is to go there again
    SimTime begun;
    SteadyTime begun_at{};  // wall time
    SteadyTime told_at{};   // of the newest feedback
  };

  void TakeOffers();
  void Begin(Active goal, const RobotInputs& inputs);
  /// By goal_pose, instead of those that it has left.
  void MakeItsGoal(Position goal);
  void Follow(const RobotInputs& inputs);
  void FollowRoute(const RobotInputs& inputs);
  void FollowOwnGoal(const RobotState& state);
  void Tell(const RobotState& state);
  void Finish(bus::GoalStatus status, const std::string& reason);
  bool IsCanceling() const;

  bus::Participant& participant_;
  const std::string robot_;
  Blackboard& board_;
  bus::Publisher<geometry_msgs::msg::PoseStamped> goal_pose_;
  std::optional<bus::ActionServer<bus::NavigateToPose>> navigate_;
  std::optional<bus::ActionServer<bus::FollowPath>> follow_;
  std::optional<Active> active_;
};

}  // namespace conav::planner
