#include "common/bus/action.h"

#include <algorithm>
#include <utility>

#include "common/runtime/text.h"

namespace conav::bus {
namespace {

// action_msgs/srv/CancelGoal
constexpr std::int8_t kUnknownGoal = 2;
constexpr std::int8_t kGoalTerminated = 3;

bool IsZero(const builtin_interfaces::msg::Time& time) {
  return time.sec() == 0 && time.nanosec() == 0;
}

bool IsAfter(const builtin_interfaces::msg::Time& one, const builtin_interfaces::msg::Time& other) {
  return std::pair(one.sec(), one.nanosec()) > std::pair(other.sec(), other.nanosec());
}

action_msgs::msg::GoalInfo Info(const GoalId& id, const builtin_interfaces::msg::Time& accepted) {
  action_msgs::msg::GoalInfo info;
  info.goal_id(ToMessage(id));
  info.stamp(accepted);
  return info;
}

}  // namespace

unique_identifier_msgs::msg::UUID ToMessage(const GoalId& id) {
  unique_identifier_msgs::msg::UUID uuid;
  uuid.uuid(id);
  return uuid;
}

std::string Text(const GoalId& id) { return Join(id, "", "{:02x}"); }

bool GoalTable::Add(const GoalId& id, const builtin_interfaces::msg::Time& accepted) {
  if (status(id) != GoalStatus::kUnknown) return false;
  const auto oldest = std::ranges::find_if(goals_, [](const Goal& g) { return IsFinal(g.status); });
  if (goals_.size() >= kKept && oldest != goals_.end()) goals_.erase(oldest);
  goals_.push_back({id, accepted, GoalStatus::kExecuting});
  return true;
}

void GoalTable::Set(const GoalId& id, GoalStatus status) {
  const auto goal = std::ranges::find(goals_, id, &Goal::id);
  if (goal != goals_.end()) goal->status = status;
}

GoalStatus GoalTable::status(const GoalId& id) const {
  const auto goal = std::ranges::find(goals_, id, &Goal::id);
  return goal == goals_.end() ? GoalStatus::kUnknown : goal->status;
}

action_msgs::srv::CancelGoal_Response GoalTable::Cancel(const action_msgs::msg::GoalInfo& request) {
  action_msgs::srv::CancelGoal_Response response;
  const GoalId id = ToGoalId(request.goal_id());
  const bool any_goal = id == GoalId{};
  const bool any_time = IsZero(request.stamp());
  if (!any_goal && any_time) {
    const GoalStatus current = status(id);
    if (current == GoalStatus::kUnknown) response.return_code(kUnknownGoal);
    if (IsFinal(current)) response.return_code(kGoalTerminated);
  }
  for (Goal& goal : goals_) {
    // With a time: all that were accepted until then, and the named one.
    const bool in_time = !any_time && !IsAfter(goal.accepted, request.stamp());
    const bool meant = goal.id == id || (any_goal && any_time) || in_time;
    if (!meant || IsFinal(goal.status)) continue;
    goal.status = GoalStatus::kCanceling;
    response.goals_canceling().push_back(Info(goal.id, goal.accepted));
  }
  return response;
}

action_msgs::msg::GoalStatusArray GoalTable::Report() const {
  action_msgs::msg::GoalStatusArray report;
  for (const Goal& goal : goals_) {
    action_msgs::msg::GoalStatus status;
    status.goal_info(Info(goal.id, goal.accepted));
    status.status(static_cast<std::int8_t>(goal.status));
    report.status_list().push_back(status);
  }
  return report;
}

}  // namespace conav::bus
