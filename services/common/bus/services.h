#pragma once

#include <string>
#include <string_view>

#include "common/bus/topics.h"
#include "common/bus/type_support.h"
#include "conav_srvs.h"
#include "ros2_services.h"

/// Every ROS 2 service and action of conav, once, as topics.h has the topics. docs/ros2.md
/// has the same table; a test compares them.
namespace conav::bus {

template <class RequestType, class ResponseType>
struct Service {
  using Request = RequestType;
  using Response = ResponseType;

  std::string_view pattern;
  std::string_view entity;  // what "{}" stands for: a robot, a world or a node
  std::string_view server;  // the processes that offer it
  std::string_view about;

  std::string NameFor(std::string_view entity) const { return FillName(pattern, entity); }
};

template <class ActionTypes>
struct Action {
  using Types = ActionTypes;

  std::string_view pattern;
  std::string_view entity;
  std::string_view server;
  std::string_view about;

  std::string NameFor(std::string_view entity) const { return FillName(pattern, entity); }
};

/// The types of an action, as ROS 2's generator names them.
#define CONAV_ACTION_TYPES(space, name)                         \
  struct name {                                                 \
    using Goal = space::name##_Goal;                            \
    using Result = space::name##_Result;                        \
    using Feedback = space::name##_Feedback;                    \
    using SendGoalRequest = space::name##_SendGoal_Request;     \
    using SendGoalResponse = space::name##_SendGoal_Response;   \
    using GetResultRequest = space::name##_GetResult_Request;   \
    using GetResultResponse = space::name##_GetResult_Response; \
    using FeedbackMessage = space::name##_FeedbackMessage;      \
  };
CONAV_ACTION_TYPES(nav2_msgs::action, NavigateToPose)
CONAV_ACTION_TYPES(nav2_msgs::action, FollowPath)
#undef CONAV_ACTION_TYPES

// clang-format off
#define CONAV_SERVICES(X) \
  X(kStopService, std_srvs::srv::Trigger, "/{}/stop", "robot", "operator", "the robot stands still, as by the stop button") \
  X(kResumeService, std_srvs::srv::Trigger, "/{}/resume", "robot", "operator", "it goes on") \
  X(kPauseService, std_srvs::srv::SetBool, "/{}/pause", "world", "sim", "simulation time stands still, or goes on") \
  X(kStepService, conav_msgs::srv::StepSimulation, "/{}/step", "world", "sim", "advances a paused simulation") \
  X(kResetService, std_srvs::srv::Trigger, "/{}/reset", "world", "sim", "the world starts again: robots, goals and time, as after a restart") \
  X(kSaveMapService, nav2_msgs::srv::SaveMap, "/{}/save_map", "world", "operator", "the operator's map as YAML and PGM, as map_server reads them") \
  X(kGetStateService, lifecycle_msgs::srv::GetState, "/{}/get_state", "node", "all", "inactive while it starts, active while it runs") \
  X(kListParametersService, rcl_interfaces::srv::ListParameters, "/{}/list_parameters", "node", "all", "") \
  X(kDescribeParametersService, rcl_interfaces::srv::DescribeParameters, "/{}/describe_parameters", "node", "all", "") \
  X(kGetParametersService, rcl_interfaces::srv::GetParameters, "/{}/get_parameters", "node", "all", "") \
  X(kGetParameterTypesService, rcl_interfaces::srv::GetParameterTypes, "/{}/get_parameter_types", "node", "all", "") \
  X(kSetParametersService, rcl_interfaces::srv::SetParameters, "/{}/set_parameters", "node", "all", "") \
  X(kSetParametersAtomicallyService, rcl_interfaces::srv::SetParametersAtomically, "/{}/set_parameters_atomically", "node", "all", "")

#define CONAV_ACTIONS(X) \
  X(kNavigateToPose, NavigateToPose, "/{}/navigate_to_pose", "robot", "planner", "the robot drives there under its planner") \
  X(kFollowPath, FollowPath, "/{}/follow_path", "robot", "planner", "the path becomes its guidance")
// clang-format on

#define CONAV_SERVICE(constant, type, pattern, entity, server, about)                         \
  inline constexpr Service<type##_Request, type##_Response> constant{pattern, entity, server, \
                                                                     about};
#define CONAV_ACTION(constant, type, pattern, entity, server, about) \
  inline constexpr Action<type> constant{pattern, entity, server, about};
CONAV_SERVICES(CONAV_SERVICE)
CONAV_ACTIONS(CONAV_ACTION)
#undef CONAV_SERVICE
#undef CONAV_ACTION

/// Calls visit(service) for each service, and visit(action) for each action.
template <class Visit>
void ForEachService(Visit&& visit) {
#define CONAV_VISIT(constant, ...) visit(constant);
  CONAV_SERVICES(CONAV_VISIT)
}
template <class Visit>
void ForEachAction(Visit&& visit) {
  CONAV_ACTIONS(CONAV_VISIT)
#undef CONAV_VISIT
}

#undef CONAV_SERVICES
#undef CONAV_ACTIONS

/// A request or reply of a service with its id.
template <class Message>
struct Envelope {
  using Enveloped = Message;

  RequestId id;
  Message message;
};

}  // namespace conav::bus
