#include "planner/robot_actions.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/msg/convert.h"
#include "common/runtime/log.h"
#include "common/service/diagnostics.h"

namespace conav::planner {
namespace {

using bus::GoalStatus;

// nav2_msgs of Jazzy: FollowPath::INVALID_PATH, ComputePathToPose::NO_VALID_PATH.
constexpr std::uint16_t kInvalidPath = 103;
constexpr std::uint16_t kNoValidPath = 208;

constexpr std::chrono::milliseconds kFeedbackPeriod{500};
/// Until a robot that keeps no goals must show its new one.
constexpr std::chrono::seconds kGoalLimit{10};

builtin_interfaces::msg::Time WallTime() { return RosWallTime(std::chrono::system_clock::now()); }

builtin_interfaces::msg::Duration ToDuration(double seconds) {
  constexpr double kLongest = 1e6;  // s
  const double clamped = std::clamp(seconds, 0.0, kLongest);
  builtin_interfaces::msg::Duration duration;
  duration.sec(static_cast<std::int32_t>(clamped));
  duration.nanosec(static_cast<std::uint32_t>((clamped - std::floor(clamped)) * 1e9));
  return duration;
}

/// Along the rest of `cells` from the robot on, metres.
double LeftOf(const std::vector<Cell>& cells, const RobotState& state) {
  const auto here = std::ranges::find(cells, state.cell);
  return static_cast<double>(std::distance(here, cells.end())) * state.grid.cell_size_m;
}

Result<std::vector<Position>> PositionsOf(const bus::NavigateToPose::Goal& goal) {
  const auto position = ToDomain(goal.pose());
  if (!position) return tl::unexpected(position.error());
  return std::vector<Position>{*position};
}

/// All in the frame of the path's header, which must be "map".
Result<std::vector<Position>> PositionsOf(const bus::FollowPath::Goal& goal) {
  std::vector<Position> positions;
  for (auto pose : goal.path().poses()) {
    pose.header().frame_id(goal.path().header().frame_id());
    const auto position = ToDomain(pose);
    if (!position) return tl::unexpected(position.error());
    positions.push_back(*position);
  }
  if (positions.empty()) return Fail(ErrorCode::kOutOfRange, "the path is empty");
  return positions;
}

bool IsReached(const RobotState& state, Position goal) {
  return std::ranges::count(state.goals_reached, state.grid.PositionToCell(goal)) > 0;
}

}  // namespace

RobotActions::RobotActions(bus::Participant& participant, std::string robot, Blackboard& board)
    : participant_(participant),
      robot_(std::move(robot)),
      board_(board),
      goal_pose_(participant, bus::kGoalPose, robot_) {}

void RobotActions::Turn() {
  if (board_.LeaseOf(robot_).state == Lease::State::kNone) return End();  // another process answers
  if (!navigate_) {
    navigate_.emplace(participant_, bus::kNavigateToPose, robot_);
    follow_.emplace(participant_, bus::kFollowPath, robot_);
  }
  TakeOffers();
  if (active_) Follow(board_.Read(robot_));
}

void RobotActions::End() {
  if (active_) {
    if (active_->route != 0) board_.CancelRoute(robot_, active_->route);
    Finish(GoalStatus::kAborted, "this planner no longer drives the robot");
  }
  // Stay: making and removing endpoints with each lease would be news to the whole domain.
  if (navigate_) navigate_->Ignore();
  if (follow_) follow_->Ignore();
}

void RobotActions::TakeOffers() {
  const auto take = [&](auto& server, bool is_path) {
    for (const auto& offer : server.Take()) {
      const RobotInputs inputs = board_.Read(robot_);
      auto positions = inputs.state ? PositionsOf(offer.goal)
                                    : Fail(ErrorCode::kUnavailable, "no state of the robot yet");
      if (!positions) {
        LOG_WARNING("goal refused", "robot", robot_, "reason", positions.error().text);
        server.Reject(offer);
      } else if (server.Accept(offer, WallTime())) {
        Begin({.is_path = is_path, .id = offer.id, .positions = *std::move(positions)}, inputs);
      }
    }
  };
  take(*navigate_, false);
  take(*follow_, true);
}

void RobotActions::Begin(Active goal, const RobotInputs& inputs) {
  if (active_) Finish(GoalStatus::kAborted, "replaced by a newer goal");
  goal.begun = inputs.state->stamp;
  goal.begun_at = std::chrono::steady_clock::now();
  const bool is_own_goal = !goal.is_path && inputs.state->goals_stamp == SimTime{};
  if (is_own_goal) {
    goal.was_reached_before = IsReached(*inputs.state, goal.positions.front());
    MakeItsGoal(goal.positions.front());
  } else {
    goal.route = board_.PutRoute(robot_, goal.positions);
  }
  LOG_INFO("goal accepted", "robot", robot_, "id", bus::Text(goal.id));
  active_ = std::move(goal);
}

void RobotActions::MakeItsGoal(Position goal) {
  geometry_msgs::msg::PoseStamped pose;
  pose.header().frame_id("map");
  pose.pose().position().x(goal.x_m);
  pose.pose().position().y(goal.y_m);
  pose.pose().orientation().w(1.0);
  bus::Send(goal_pose_, pose);
}

bool RobotActions::IsCanceling() const {
  const auto status =
      active_->is_path ? follow_->status(active_->id) : navigate_->status(active_->id);
  return status == GoalStatus::kCanceling;
}

void RobotActions::Follow(const RobotInputs& inputs) {
  if (IsCanceling()) {
    if (active_->route != 0) {
      board_.CancelRoute(robot_, active_->route);
    } else {
      MakeItsGoal(inputs.state->position);  // it has no other: there it stands
    }
    return Finish(GoalStatus::kCanceled, "canceled");
  }
  if (active_->route != 0) {
    FollowRoute(inputs);
  } else {
    FollowOwnGoal(*inputs.state);
  }
  if (active_) Tell(*inputs.state);
}

void RobotActions::FollowRoute(const RobotInputs& inputs) {
  const RouteStatus status = board_.RouteStatusOf(robot_);
  if (status.number != active_->route)
    return Finish(GoalStatus::kAborted, "replaced by a goal pose");
  switch (status.stage) {
    case RouteStatus::Stage::kWaits:
      return;
    case RouteStatus::Stage::kRefused:
      return Finish(GoalStatus::kAborted, status.reason);
    case RouteStatus::Stage::kReplaced:
      return Finish(GoalStatus::kAborted, "the operator gave the robot another path");
    case RouteStatus::Stage::kReached:
      return Finish(GoalStatus::kSucceeded, "");
    case RouteStatus::Stage::kTaken:
      break;
  }
  if (inputs.guidance && inputs.guidance->valid_until < inputs.state->stamp) {
    Finish(GoalStatus::kAborted, "the guidance ended before the robot arrived");
  }
}

void RobotActions::FollowOwnGoal(const RobotState& state) {
  const Cell goal = state.grid.PositionToCell(active_->positions.front());
  const bool is_its_goal = std::ranges::find(state.goals_left, goal) != state.goals_left.end();
  active_->was_its_goal |= is_its_goal;
  if (is_its_goal) return;
  const bool reached = IsReached(state, active_->positions.front());
  // Until the operator service has made it a goal again, it still counts as reached.
  active_->was_reached_before &= reached && !active_->was_its_goal;
  const bool late = std::chrono::steady_clock::now() - active_->begun_at > kGoalLimit;
  const bool is_there = state.cell == goal || (reached && (late || !active_->was_reached_before));
  if (is_there) return Finish(GoalStatus::kSucceeded, "");
  if (active_->was_its_goal) return Finish(GoalStatus::kAborted, "the operator removed the goal");
  if (late) Finish(GoalStatus::kAborted, "the operator service did not make it the robot's goal");
}

void RobotActions::Tell(const RobotState& state) {
  const auto now = std::chrono::steady_clock::now();
  if (now - active_->told_at < kFeedbackPeriod) return;
  active_->told_at = now;
  const std::vector<Cell> path = board_.Read(robot_).guidance.value_or(Guidance{}).path;
  const bool is_on_path = active_->route != 0 && std::ranges::find(path, state.cell) != path.end();
  const double left_m =
      is_on_path ? LeftOf(path, state) : Distance(state.position, active_->positions.back());
  if (active_->is_path) {
    bus::FollowPath::Feedback feedback;
    feedback.distance_to_goal(static_cast<float>(left_m));
    feedback.speed(static_cast<float>(state.speed_mps));
    return follow_->SendFeedback(active_->id, feedback);
  }
  bus::NavigateToPose::Feedback feedback;
  feedback.current_pose().header().frame_id("map");
  feedback.current_pose().header().stamp(ToMessage(state.stamp));
  feedback.current_pose().pose().position().x(state.position.x_m);
  feedback.current_pose().pose().position().y(state.position.y_m);
  feedback.current_pose().pose().orientation(ToQuaternion(state.heading_rad));
  const double driven_s = state.stamp.ToSeconds() - active_->begun.ToSeconds();
  feedback.navigation_time(ToDuration(driven_s));
  constexpr double kSlowest = 0.05;  // m/s: of a robot that looks around
  feedback.estimated_time_remaining(
      ToDuration(left_m / std::max(std::abs(state.speed_mps), kSlowest)));
  feedback.distance_remaining(static_cast<float>(left_m));
  navigate_->SendFeedback(active_->id, feedback);
}

void RobotActions::Finish(GoalStatus status, const std::string& reason) {
  const Active goal = *std::exchange(active_, std::nullopt);
  const bool failed = status == GoalStatus::kAborted;
  LOG_INFO("goal ended", "robot", robot_, "id", bus::Text(goal.id), "status",
           status == GoalStatus::kSucceeded ? "succeeded"
           : failed                         ? "aborted"
                                            : "canceled",
           "reason", reason);
  if (goal.is_path) {
    bus::FollowPath::Result result;
    result.error_code(failed ? kInvalidPath : 0);
    follow_->Finish(goal.id, status, result);
  } else {
    bus::NavigateToPose::Result result;
    result.error_code(failed ? kNoValidPath : 0);
    navigate_->Finish(goal.id, status, result);
  }
}

}  // namespace conav::planner
