#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "common/bus/services.h"

namespace conav::bus {

/// The UUID that an action's client gives its goal.
using GoalId = std::array<std::uint8_t, 16>;

inline GoalId ToGoalId(const unique_identifier_msgs::msg::UUID& uuid) { return uuid.uuid(); }
unique_identifier_msgs::msg::UUID ToMessage(const GoalId& id);
/// "0f3a...", 32 digits.
std::string Text(const GoalId& id);

/// action_msgs/msg/GoalStatus. The last three are final.
enum class GoalStatus : std::int8_t {
  kUnknown,
  kAccepted,
  kExecuting,
  kCanceling,
  kSucceeded,
  kCanceled,
  kAborted
};

constexpr bool IsFinal(GoalStatus status) { return status >= GoalStatus::kSucceeded; }

/// The goals of an action's server: their status, and which of them a request to cancel means, by the
/// rules of ROS 2's design (design.ros2.org/articles/actions.html). Final goals are kept for their
/// results, the last kKept.
class GoalTable {
 public:
  static constexpr std::size_t kKept = 100;

  /// Adds an executing goal; false if it is known.
  bool Add(const GoalId& id, const builtin_interfaces::msg::Time& accepted);
  void Set(const GoalId& id, GoalStatus status);
  /// kUnknown for goals that are not known.
  GoalStatus status(const GoalId& id) const;

  /// Sets the goals that the request means to canceling; the reply lists them.
  action_msgs::srv::CancelGoal_Response Cancel(const action_msgs::msg::GoalInfo& request);

  action_msgs::msg::GoalStatusArray Report() const;

 private:
  struct Goal {
    GoalId id;
    builtin_interfaces::msg::Time accepted;
    GoalStatus status;
  };

  std::vector<Goal> goals_;  // in order of arrival
};

}  // namespace conav::bus
