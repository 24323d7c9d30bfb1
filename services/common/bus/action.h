#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/bus/service.h"

/// ROS 2 actions: three services (send_goal, cancel_goal, get_result) and two topics (feedback, status)
/// below "<name>/_action/".
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

inline constexpr Qos kActionStatusQos = kLatchedQos;

/// An action that this process offers. Constructing connects, destroying disconnects; goals that are
/// open then get no result, so a service that ends aborts them first.
/// `Types` are those of an Action (services.h).
/// Threads: one at a time.
template <class Types>
class ActionServer {
 public:
  struct Offer {
    RequestId request;
    GoalId id;
    typename Types::Goal goal;
  };

  ActionServer(Participant& participant, const Action<Types>& action, std::string_view entity);

  /// Goals that clients sent since the last call, each to be answered by Accept or Reject. Answers
  /// requests for results and to cancel, so call it often.
  std::vector<Offer> Take();
  /// From now on the goal executes, unless one with its id is known: then it is rejected and this
  /// returns false.
  bool Accept(const Offer& offer, const builtin_interfaces::msg::Time& now);
  void Reject(const Offer& offer);
  /// Instead of Take() while another process serves: leaves requests about goals that are not known
  /// here to it.
  void Ignore();

  /// kCanceling once a client asked for it; the server then ends the goal as soon as it can.
  GoalStatus status(const GoalId& id) const { return goals_.status(id); }

  void SendFeedback(const GoalId& id, typename Types::Feedback feedback);
  /// `status` is final.
  void Finish(const GoalId& id, GoalStatus status, typename Types::Result result);

 private:
  void ReplyResult(const RequestId& request, const GoalId& id);
  void ReportStatus() { Send(status_, goals_.Report()); }

  GoalTable goals_;
  ServiceServer<typename Types::SendGoalRequest, typename Types::SendGoalResponse> send_goal_;
  ServiceServer<action_msgs::srv::CancelGoal_Request, action_msgs::srv::CancelGoal_Response>
      cancel_goal_;
  ServiceServer<typename Types::GetResultRequest, typename Types::GetResultResponse> get_result_;
  Publisher<typename Types::FeedbackMessage> feedback_;
  Publisher<action_msgs::msg::GoalStatusArray> status_;
  std::map<GoalId, typename Types::Result> results_;
  std::vector<std::pair<RequestId, GoalId>> awaited_;
};

template <class Types>
ActionServer<Types>::ActionServer(Participant& participant, const Action<Types>& action,
                                  std::string_view entity)
    : send_goal_(participant, action.NameFor(entity) + "/_action/send_goal"),
      cancel_goal_(participant, action.NameFor(entity) + "/_action/cancel_goal"),
      get_result_(participant, action.NameFor(entity) + "/_action/get_result"),
      feedback_(participant, {action.NameFor(entity) + "/_action/feedback", kDefaultQos, {}, {}}),
      status_(participant, {action.NameFor(entity) + "/_action/status", kActionStatusQos, {}, {}}) {
}

template <class Types>
auto ActionServer<Types>::Take() -> std::vector<Offer> {
  cancel_goal_.Serve([this](const auto& request) {
    auto response = goals_.Cancel(request.goal_info());
    ReportStatus();
    return response;
  });
  for (auto& call : get_result_.Take()) ReplyResult(call.id, ToGoalId(call.request.goal_id()));
  std::vector<Offer> offers;
  for (auto& call : send_goal_.Take()) {
    offers.push_back({call.id, ToGoalId(call.request.goal_id()), std::move(call.request.goal())});
  }
  return offers;
}

template <class Types>
void ActionServer<Types>::Ignore() {
  cancel_goal_.Take();
  send_goal_.Take();
  for (auto& call : get_result_.Take()) {
    const GoalId id = ToGoalId(call.request.goal_id());
    if (goals_.status(id) != GoalStatus::kUnknown) ReplyResult(call.id, id);
  }
}

template <class Types>
bool ActionServer<Types>::Accept(const Offer& offer, const builtin_interfaces::msg::Time& now) {
  typename Types::SendGoalResponse response;
  response.accepted(goals_.Add(offer.id, now));
  response.stamp(now);
  send_goal_.Reply(offer.request, response);
  ReportStatus();
  return response.accepted();
}

template <class Types>
void ActionServer<Types>::Reject(const Offer& offer) {
  send_goal_.Reply(offer.request, {});
}

template <class Types>
void ActionServer<Types>::SendFeedback(const GoalId& id, typename Types::Feedback feedback) {
  typename Types::FeedbackMessage message;
  message.goal_id(ToMessage(id));
  message.feedback(std::move(feedback));
  Send(feedback_, message);
}

template <class Types>
void ActionServer<Types>::Finish(const GoalId& id, GoalStatus status,
                                 typename Types::Result result) {
  goals_.Set(id, status);
  results_[id] = std::move(result);
  std::erase_if(results_, [this](const auto& kept) {
    return goals_.status(kept.first) == GoalStatus::kUnknown;
  });
  ReportStatus();
  for (const auto& [request, goal] : std::exchange(awaited_, {})) ReplyResult(request, goal);
}

template <class Types>
void ActionServer<Types>::ReplyResult(const RequestId& request, const GoalId& id) {
  const GoalStatus status = goals_.status(id);
  if (status != GoalStatus::kUnknown && !IsFinal(status)) {
    awaited_.emplace_back(request, id);
    return;
  }
  typename Types::GetResultResponse response;
  response.status(static_cast<std::int8_t>(status));
  if (const auto result = results_.find(id); result != results_.end()) {
    response.result(result->second);
  }
  get_result_.Reply(request, std::move(response));
}

/// Sends goals to an action's server, one at a time. Constructing connects, destroying disconnects
/// and leaves the goal to the server.
/// Threads: one at a time.
template <class Types>
class ActionClient {
 public:
  /// What became of the newest goal.
  struct Progress {
    /// kUnknown = the server has not answered yet; kAborted also if it rejected the goal.
    GoalStatus status = GoalStatus::kUnknown;
    std::optional<typename Types::Feedback> feedback;  // the newest
    std::optional<typename Types::Result> result;      // of an ended goal
  };

  /// `name` as in "/tb3/navigate_to_pose".
  ActionClient(Participant& participant, const std::string& name);

  /// Whether a server is there and has had time to discover this client.
  bool IsReady() {
    // Each keeps its own time.
    const bool sends = send_goal_.IsReady();
    const bool cancels = cancel_goal_.IsReady();
    return get_result_.IsReady() && sends && cancels;
  }
  /// Forgets the earlier goal; servers with one goal at a time end it by themselves. False = the
  /// bus did not take it. `id` must be new.
  bool Send(const GoalId& id, typename Types::Goal goal);
  /// Asks the server to end the goal; its status then changes.
  void Cancel();
  /// Takes what the server sent.
  const Progress& Turn();

 private:
  GoalId id_{};
  Progress progress_;
  std::optional<std::int64_t> send_number_;
  std::optional<std::int64_t> result_number_;
  bool cancels_ = false;
  ServiceClient<typename Types::SendGoalRequest, typename Types::SendGoalResponse> send_goal_;
  ServiceClient<action_msgs::srv::CancelGoal_Request, action_msgs::srv::CancelGoal_Response>
      cancel_goal_;
  ServiceClient<typename Types::GetResultRequest, typename Types::GetResultResponse> get_result_;
  Subscriber<typename Types::FeedbackMessage> feedback_;
};

template <class Types>
ActionClient<Types>::ActionClient(Participant& participant, const std::string& name)
    : send_goal_(participant, name + "/_action/send_goal"),
      cancel_goal_(participant, name + "/_action/cancel_goal"),
      get_result_(participant, name + "/_action/get_result"),
      feedback_(participant, {name + "/_action/feedback", kDefaultQos, {}, {}}) {}

template <class Types>
bool ActionClient<Types>::Send(const GoalId& id, typename Types::Goal goal) {
  id_ = id;
  progress_ = {};
  cancels_ = false;
  result_number_.reset();
  typename Types::SendGoalRequest request;
  request.goal_id(ToMessage(id));
  request.goal(std::move(goal));
  send_number_ = send_goal_.Call(std::move(request));
  return send_number_.has_value();
}

template <class Types>
void ActionClient<Types>::Cancel() {
  cancels_ = true;
  action_msgs::srv::CancelGoal_Request request;
  request.goal_info().goal_id(ToMessage(id_));
  cancel_goal_.Call(std::move(request));
}

template <class Types>
auto ActionClient<Types>::Turn() -> const Progress& {
  for (const auto& reply : send_goal_.Take()) {
    if (reply.number != send_number_) continue;
    progress_.status = reply.response.accepted() ? GoalStatus::kExecuting : GoalStatus::kAborted;
    if (!reply.response.accepted()) continue;
    typename Types::GetResultRequest request;
    request.goal_id(ToMessage(id_));
    result_number_ = get_result_.Call(std::move(request));
    // The server may have got the earlier request before it knew the goal.
    if (cancels_) Cancel();
  }
  for (auto& reply : get_result_.Take()) {
    if (reply.number != result_number_) continue;
    progress_.status = static_cast<GoalStatus>(reply.response.status());
    progress_.result = std::move(reply.response.result());
  }
  for (auto& message : feedback_.Take()) {
    if (ToGoalId(message.goal_id()) == id_) progress_.feedback = std::move(message.feedback());
  }
  cancel_goal_.Take();
  return progress_;
}

}  // namespace conav::bus
