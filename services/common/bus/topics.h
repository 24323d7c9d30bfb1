#pragma once

#include <array>
#include <string>
#include <string_view>
#include <tuple>

#include "common/bus/qos.h"
#include "conav_operator.h"
#include "conav_planning.h"
#include "conav_robot.h"
#include "ros2_interfaces.h"

/// The one table of conav's topics, with type and QoS, and lists for code that handles all of them
/// alike, such as the recorder. A test checks that the lists are complete.
namespace conav::bus {

/// `pattern` is the ROS name; "{}" stands for a robot or a world. The bus adds the "rt" prefix.
template <class T>
struct Topic {
  std::string_view pattern;
  Qos qos;

  /// "/r1/state" for entity "r1".
  std::string NameFor(std::string_view entity) const {
    const auto brace = pattern.find("{}");
    if (brace == std::string_view::npos) return std::string(pattern);
    return std::string(pattern.substr(0, brace)).append(entity).append(pattern.substr(brace + 2));
  }
};

// per robot
inline constexpr Topic<nav_msgs::msg::OccupancyGrid> kRobotMap{"/{}/map", kLatchedQos};
inline constexpr Topic<nav_msgs::msg::Odometry> kOdometry{"/{}/odom", kDefaultQos};
inline constexpr Topic<tf2_msgs::msg::TFMessage> kTransforms{"/{}/tf", kTransformQos};
inline constexpr Topic<conav_msgs::msg::RobotState> kRobotState{"/{}/state", kLatchedQos};
inline constexpr Topic<conav_msgs::msg::RobotCommand> kRobotCommand{"/{}/command", kLatchedQos};
inline constexpr Topic<sensor_msgs::msg::CompressedImage> kCameraImage{
    "/{}/camera/image/compressed", kSensorQos};
inline constexpr Topic<sensor_msgs::msg::CameraInfo> kCameraInfo{"/{}/camera/camera_info",
                                                                 kLatchedQos};
inline constexpr Topic<conav_msgs::msg::Snapshot> kSnapshot{"/{}/snapshot", kEventQos};
inline constexpr Topic<conav_msgs::msg::Guidance> kGuidance{"/{}/guidance", kLatchedQos};
inline constexpr Topic<conav_msgs::msg::DriveOrder> kDriveOrder{"/{}/drive", kNewestQos};
inline constexpr Topic<conav_msgs::msg::StopOrder> kStopOrder{"/{}/stop", kLatchedQos};
inline constexpr Topic<geometry_msgs::msg::PoseStamped> kGoalPose{"/{}/goal_pose", kDefaultQos};
inline constexpr Topic<nav_msgs::msg::Path> kPlan{"/{}/plan", kLatchedQos};
inline constexpr Topic<conav_msgs::msg::SearchReport> kSearchReport{"/{}/search", kEventQos};
inline constexpr Topic<conav_msgs::msg::AttentionRequest> kAttention{"/{}/attention", kEventQos};
inline constexpr Topic<conav_msgs::msg::IntendedPath> kIntendedPath{"/{}/intended_path",
                                                                    kLatchedQos};

// per world
inline constexpr Topic<conav_msgs::msg::BeliefMap> kBelief{"/{}/belief", kLatchedQos};
inline constexpr Topic<nav_msgs::msg::OccupancyGrid> kBeliefMap{"/{}/belief/map", kLatchedQos};
inline constexpr Topic<nav_msgs::msg::OccupancyGrid> kInitialMap{"/{}/initial_map", kLatchedQos};
inline constexpr Topic<nav_msgs::msg::OccupancyGrid> kTruth{"/{}/truth", kLatchedQos};
inline constexpr Topic<visualization_msgs::msg::MarkerArray> kGoals{"/{}/goals", kLatchedQos};

// system
inline constexpr Topic<conav_msgs::msg::OperatorRequest> kOperatorRequest{"/conav/operator/request",
                                                                          kRequestQos};
inline constexpr Topic<conav_msgs::msg::OperatorReply> kOperatorReply{"/conav/operator/reply",
                                                                      kRequestQos};
inline constexpr Topic<conav_msgs::msg::PlannerLease> kPlannerLease{"/conav/planner/lease",
                                                                    kEventQos};
inline constexpr Topic<conav_msgs::msg::AttentionQueue> kAttentionQueue{
    "/conav/operator/attention_queue", kLatchedQos};
inline constexpr Topic<conav_msgs::msg::PerceptionRequest> kPerceptionRequest{
    "/conav/perception/request", kQueryQos};
inline constexpr Topic<conav_msgs::msg::PerceptionReply> kPerceptionReply{"/conav/perception/reply",
                                                                          kQueryQos};
inline constexpr Topic<rosgraph_msgs::msg::Clock> kClock{"/clock", kClockQos};
inline constexpr Topic<diagnostic_msgs::msg::DiagnosticArray> kDiagnostics{"/diagnostics",
                                                                           kDefaultQos};
inline constexpr Topic<rcl_interfaces::msg::Log> kRosout{"/rosout", kEventQos};

inline constexpr std::tuple kRobotTopics{kRobotMap,     kOdometry,     kTransforms, kRobotState,
                                         kRobotCommand, kCameraImage,  kCameraInfo, kSnapshot,
                                         kGuidance,     kDriveOrder,   kStopOrder,  kGoalPose,
                                         kPlan,         kSearchReport, kAttention,  kIntendedPath};

inline constexpr std::tuple kWorldTopics{kBelief, kBeliefMap, kInitialMap, kTruth, kGoals};

inline constexpr std::tuple kSystemTopics{kOperatorRequest, kOperatorReply,     kPlannerLease,
                                          kAttentionQueue,  kPerceptionRequest, kPerceptionReply,
                                          kClock,           kDiagnostics,       kRosout};

/// Patterns of the topics that stream pictures, with many times the bytes of all others.
inline constexpr std::array kStreamPatterns{kCameraImage.pattern};

/// Calls visit(topic) for each topic of one of the lists.
template <class Topics, class Visit>
void ForEachTopic(const Topics& topics, Visit&& visit) {
  std::apply([&](const auto&... topic) { (visit(topic), ...); }, topics);
}

}  // namespace conav::bus
