#pragma once

#include <array>
#include <string>
#include <string_view>

#include "common/bus/qos.h"
#include "conav_msgs.h"
#include "ros2_interfaces.h"

/// Every topic of conav, once: constant, type, ROS name, QoS, publisher -> subscribers, and what the
/// type does not say. "{}" in a name stands for a robot or a world; the bus adds the "rt" prefix.
/// README.md has the same table; a test compares the two. `./conav keystore` makes each program's
/// permissions of it (deploy/keystore/role_topics.cc).
namespace conav::bus {

/// `name` with `entity` in place of its "{}".
inline std::string FillName(std::string_view name, std::string_view entity) {
  const auto brace = name.find("{}");
  if (brace == std::string_view::npos) return std::string(name);
  return std::string(name.substr(0, brace)).append(entity).append(name.substr(brace + 2));
}

template <class T>
struct Topic {
  using Type = T;

  std::string_view pattern;
  Qos qos;
  std::string_view direction;  // "sim -> all"
  std::string_view about;      // what the type does not say; may be empty

  /// "/r1/state" for entity "r1".
  std::string NameFor(std::string_view entity) const { return FillName(pattern, entity); }
};

// clang-format off
#define CONAV_ROBOT_TOPICS(X) \
  X(kRobotMap, nav_msgs::msg::OccupancyGrid, "/{}/map", kLatchedQos, "robot -> planner, operator", "what this robot has seen") \
  X(kRobotMapChanges, conav_msgs::msg::MessageChange, "/{}/map_changes", kChangesQos, "robot -> planner, operator", "the same for links") \
  X(kOdometry, nav_msgs::msg::Odometry, "/{}/odom", kDefaultQos, "sim -> all", "") \
  X(kTransforms, tf2_msgs::msg::TFMessage, "/{}/tf", kTransformQos, "sim -> all", "plain frame ids, as Nav2") \
  X(kFixedTransforms, tf2_msgs::msg::TFMessage, "/{}/tf_static", kLatchedQos, "sim -> all", "plain frame ids") \
  X(kRobotDescription, std_msgs::msg::String, "/{}/robot_description", kLatchedQos, "sim -> all", "its URDF") \
  X(kRobotState, conav_msgs::msg::RobotState, "/{}/state", kLatchedQos, "robot -> all", "") \
  X(kThrottledState, conav_msgs::msg::RobotState, "/{}/state_throttle", kLatchedQos, "robot -> operator", "fewer and shorter states for links: two a second, urgent ones at once") \
  X(kRobotGoals, conav_msgs::msg::RobotGoals, "/{}/goals", kLatchedQos, "sim (episode) or operator (field) -> all", "its goals, in any order of visit") \
  X(kRobotCommand, conav_msgs::msg::RobotCommand, "/{}/command", kLatchedQos, "planner -> robot", "expiry, lease epoch, sequence") \
  X(kCameraImage, sensor_msgs::msg::CompressedImage, "/{}/camera/image/compressed", kImageQos, "sim -> all", "each snapshot, streamed frames, and live ones while watched") \
  X(kCameraInfo, sensor_msgs::msg::CameraInfo, "/{}/camera/camera_info", kLatchedQos, "robot -> all", "with the stamp of each image") \
  X(kSnapshot, conav_msgs::msg::Snapshot, "/{}/snapshot", kSnapshotQos, "robot -> operator's side", "JPEG, pose, cells seen; for a streamed frame only what it shows") \
  X(kGuidance, conav_msgs::msg::Guidance, "/{}/guidance", kLatchedQos, "operator -> planner, operator's side", "a path and its expiry") \
  X(kDriveOrder, conav_msgs::msg::DriveOrder, "/{}/drive", kNewestQos, "operator -> planner (teleoperation)", "one low-level action and its expiry") \
  X(kStopOrder, conav_msgs::msg::StopOrder, "/{}/stop", kLatchedQos, "operator -> robot, planner, operator's side", "stop or resume") \
  X(kGoalPose, geometry_msgs::msg::PoseStamped, "/{}/goal_pose", kDefaultQos, "anyone -> planner (episode), operator (field)", "as RViz sends it: guidance, or the robot's goal") \
  X(kPlan, nav_msgs::msg::Path, "/{}/plan", kLatchedQos, "planner -> all", "") \
  X(kSearchReport, conav_msgs::msg::SearchReport, "/{}/search", kEventQos, "planner -> all", "root actions, values and terms, timing; the tree on demand") \
  X(kAttention, conav_msgs::msg::AttentionRequest, "/{}/attention", kEventQos, "planner -> operator's side, planners", "reason, cost of waiting, deadline") \
  X(kIntendedPath, conav_msgs::msg::IntendedPath, "/{}/intended_path", kLatchedQos, "planner -> planners", "the cells it intends to enter next, for the right of way")

#define CONAV_WORLD_TOPICS(X) \
  X(kBelief, conav_msgs::msg::BeliefMap, "/{}/belief", kLatchedQos, "operator -> all", "the operator's map and its revision") \
  X(kBeliefChanges, conav_msgs::msg::MessageChange, "/{}/belief_changes", kChangesQos, "operator -> planner, clients", "the same for links") \
  X(kBeliefMap, nav_msgs::msg::OccupancyGrid, "/{}/belief/map", kLatchedQos, "operator -> all", "the same for RViz") \
  X(kInitialMap, nav_msgs::msg::OccupancyGrid, "/{}/initial_map", kLatchedQos, "sim -> operator, driver, recorder", "what the operator starts from") \
  X(kTruth, nav_msgs::msg::OccupancyGrid, "/{}/truth", kLatchedQos, "sim -> operator, recorder; planner in the mapping task", "") \
  X(kGoals, visualization_msgs::msg::MarkerArray, "/{}/goals", kLatchedQos, "sim -> all", "")

#define CONAV_SYSTEM_TOPICS(X) \
  X(kOperatorRequest, conav_msgs::msg::OperatorRequest, "/conav/operator/request", kRequestQos, "clients -> operator", "edits, paths, answers, stop and resume, control") \
  X(kOperatorReply, conav_msgs::msg::OperatorReply, "/conav/operator/reply", kRequestQos, "operator -> clients", "") \
  X(kOperatorEvent, conav_msgs::msg::OperatorEvent, "/conav/operator/event", kEventQos, "operator -> all", "the command log: who asked for what, and notes") \
  X(kPlannerLease, conav_msgs::msg::PlannerLease, "/conav/planner/lease", kEventQos, "planner -> planners, launcher", "which process drives which robots") \
  X(kAttentionQueue, conav_msgs::msg::AttentionQueue, "/conav/operator/attention_queue", kLatchedQos, "operator -> clients", "what needs the operator first, and the workload") \
  X(kPerceptionRequest, conav_msgs::msg::PerceptionRequest, "/conav/perception/request", kQueryQos, "planner, operator -> nhpm", "batches of queries") \
  X(kPerceptionReply, conav_msgs::msg::PerceptionReply, "/conav/perception/reply", kQueryQos, "nhpm -> planner", "") \
  X(kPredictionReply, conav_msgs::msg::PerceptionReply, "/conav/perception/prediction", kQueryQos, "nhpm -> operator", "replies to consoles") \
  X(kClock, rosgraph_msgs::msg::Clock, "/clock", kClockQos, "sim of the first world -> all", "") \
  X(kFleetTransforms, tf2_msgs::msg::TFMessage, "/tf", kTransformQos, "sims -> all", "of all robots, frame ids as `r1/base_link`") \
  X(kFleetFixedTransforms, tf2_msgs::msg::TFMessage, "/tf_static", kLatchedQos, "sims -> all", "of all robots") \
  X(kDiagnostics, diagnostic_msgs::msg::DiagnosticArray, "/diagnostics", kHealthQos, "all services -> all", "") \
  X(kRosout, rcl_interfaces::msg::Log, "/rosout", kEventQos, "all services -> all", "") \
  X(kParameterEvents, rcl_interfaces::msg::ParameterEvent, "/parameter_events", kParameterQos, "all services -> all", "where the ROS 2 distribution is known") \
  X(kClockProbe, rosgraph_msgs::msg::Clock, "/conav/clock_probe", kClockQos, "operator, tools -> all", "the sender's time; the next report on /diagnostics answers it, which gives the offset of the clocks") \
  X(kStudyMark, conav_msgs::msg::StudyMark, "/conav/study/mark", kEventQos, "operator -> recorder, tools", "begin and end of trials, baselines, pauses") \
  X(kPageLayout, conav_msgs::msg::PageLayout, "/conav/operator/page_layout", kEventQos, "operator -> recorder, tools", "where a participant's page shows what") \
  X(kEyePupil, conav_msgs::msg::EyePupil, "/conav/eye/pupil", kSampleQos, "tools -> recorder", "") \
  X(kEyeGaze, conav_msgs::msg::EyeGaze, "/conav/eye/gaze", kSampleQos, "tools -> recorder", "in the world camera's picture, and on surfaces") \
  X(kEyeFixation, conav_msgs::msg::EyeFixation, "/conav/eye/fixation", kSampleQos, "tools -> recorder", "") \
  X(kEyeBlink, conav_msgs::msg::EyeBlink, "/conav/eye/blink", kSampleQos, "tools -> recorder", "") \
  X(kEyeClock, conav_msgs::msg::EyeClock, "/conav/eye/clock", kEventQos, "tools -> recorder, operator", "the tracker's clock against UTC")
// clang-format on

#define CONAV_TOPIC(constant, type, pattern, qos, direction, about) \
  inline constexpr Topic<type> constant{pattern, qos, direction, about};
CONAV_ROBOT_TOPICS(CONAV_TOPIC)
CONAV_WORLD_TOPICS(CONAV_TOPIC)
CONAV_SYSTEM_TOPICS(CONAV_TOPIC)
#undef CONAV_TOPIC

/// Calls visit(topic) for each topic of a robot, of a world, of neither.
template <class Visit>
void ForEachRobotTopic(Visit&& visit) {
#define CONAV_VISIT(constant, ...) visit(constant);
  CONAV_ROBOT_TOPICS(CONAV_VISIT)
}
template <class Visit>
void ForEachWorldTopic(Visit&& visit) {
  CONAV_WORLD_TOPICS(CONAV_VISIT)
}
template <class Visit>
void ForEachSystemTopic(Visit&& visit) {
  CONAV_SYSTEM_TOPICS(CONAV_VISIT)
#undef CONAV_VISIT
}

#undef CONAV_ROBOT_TOPICS
#undef CONAV_WORLD_TOPICS
#undef CONAV_SYSTEM_TOPICS

/// The topic for a subscriber that does not ask for the full rate.
template <class T>
constexpr Topic<T> Sparse(Topic<T> topic) {
  topic.qos.demand = Demand::kSparse;
  return topic;
}

/// nhpm answers clients whose names begin so on kPredictionReply: the replies to planners, which come
/// with each decision, would be most of what the operator's link carries.
inline constexpr std::string_view kConsoleClient = "console-";

/// Patterns of the topics that stream pictures, with many times the bytes of all others.
inline constexpr std::array kStreamPatterns{kCameraImage.pattern};

/// Patterns of the topics that say over links what others say whole.
inline constexpr std::array kLinkPatterns{kThrottledState.pattern, kRobotMapChanges.pattern,
                                          kBeliefChanges.pattern};

/// Patterns of the topics that come many times a second, of the simulator only while somebody asks
/// for the full rate (Demand).
inline constexpr std::array kMotionPatterns{kClock.pattern, kOdometry.pattern, kTransforms.pattern,
                                            kFleetTransforms.pattern};

}  // namespace conav::bus
