#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "common/bus/participant.h"
#include "common/runtime/config.h"

namespace conav::robot {

/// How the robot is moved.
enum class WayToMove { kCmdVel, kGoalPose, kNavigateToPose };

inline constexpr std::array kWaysToMove{WayToMove::kCmdVel, WayToMove::kGoalPose,
                                        WayToMove::kNavigateToPose};

constexpr std::string_view Name(WayToMove way) {
  switch (way) {
    case WayToMove::kCmdVel:
      return "cmd_vel";
    case WayToMove::kGoalPose:
      return "goal_pose";
    case WayToMove::kNavigateToPose:
      return "navigate_to_pose";
  }
  return "";
}

/// The robot's own topics. A name without a leading / stands in driver.namespace; empty = the robot
/// has none, where that is allowed.
struct RobotTopicsConfig {
  std::string odometry = "odom";  // may be empty where TF leads from the map to the robot
  std::string tf = "tf";          // empty: odometry is in the map's frame
  std::string tf_static = "tf_static";
  /// Of a SLAM or a costmap; never conav's own /<robot>/map.
  std::string map = "map";
  /// A name that ends with /compressed is sensor_msgs/CompressedImage, any other sensor_msgs/Image.
  std::string image = "camera/image_raw/compressed";
  std::string camera_info = "camera/camera_info";
  std::string depth;  // sensor_msgs/Image, 16UC1 or 32FC1, aligned with the picture
  std::string cmd_vel = "cmd_vel";
  std::string goal_pose = "goal_pose";                // never conav's own /<robot>/goal_pose
  std::string navigate_to_pose = "navigate_to_pose";  // the action; never conav's own of the robot
  /// std_msgs/Float64: the angle of the camera's joint in radians.
  std::string pan;

  void Visit(ConfigReader& reader) {
    reader.Field("odometry", odometry);
    reader.Field("tf", tf);
    reader.Field("tf_static", tf_static);
    reader.Field("map", map);
    reader.Field("image", image);
    reader.Field("camera_info", camera_info);
    reader.Field("depth", depth);
    reader.Field("cmd_vel", cmd_vel);
    reader.Field("goal_pose", goal_pose);
    reader.Field("navigate_to_pose", navigate_to_pose);
    reader.Field("pan", pan);
  }
};

/// Names of the robot's frames in TF and odometry.
struct FramesConfig {
  std::string map = "map";
  std::string odom = "odom";
  std::string base = "base_link";

  void Visit(ConfigReader& reader) {
    reader.Field("map", map);
    reader.Field("odom", odom);
    reader.Field("base", base);
  }
};

/// Where the robot's map lies on the operator's plan: its origin and turn there, or pairs of points.
struct AlignmentConfig {
  double x_m = 0.0;
  double y_m = 0.0;
  double yaw_deg = 0.0;
  /// Three or more [x, y on the robot's map, x, y on the plan], metres; then the three above do not
  /// count.
  std::vector<std::vector<double>> pairs;
  /// A pair that is further off the best fit stops the start.
  double most_residual_m = 0.5;

  void Visit(ConfigReader& reader) {
    reader.Field("x_m", x_m, -1e6, 1e6);
    reader.Field("y_m", y_m, -1e6, 1e6);
    reader.Field("yaw_deg", yaw_deg, -360.0, 360.0);
    reader.Field("pairs", pairs);
    reader.Field("most_residual_m", most_residual_m, 0.001, 100.0);
  }
};

struct MoveConfig {
  WayToMove by = WayToMove::kCmdVel;
  /// Of the disc that holds the robot: walls of its map are thickened by it.
  double radius_m = 0.25;
  double speed_mps = 0.3;
  double turn_rps = 0.8;
  double acceleration_mps2 = 0.5;
  /// cmd_vel is geometry_msgs/TwistStamped.
  bool stamped = false;
  /// Of a robot that has turned; else than with cmd_vel at least that of the robot's own navigation.
  double heading_tolerance_rad = 0.05;
  /// Without progress for so long the way is blocked, and a wall on its map for `blocked_for_s`.
  double stuck_s = 10.0;
  double blocked_for_s = 60.0;
  /// Kept free between two robots, besides their radii.
  double clearance_m = 0.3;
  /// It waits for another robot on its way for so long before that ends the command.
  double wait_s = 4.0;

  void Visit(ConfigReader& reader) {
    reader.Choice("by", by, kWaysToMove);
    reader.Field("radius_m", radius_m, 0.01, 5.0);
    reader.Field("speed_mps", speed_mps, 0.02, 5.0);
    reader.Field("turn_rps", turn_rps, 0.05, 5.0);
    reader.Field("acceleration_mps2", acceleration_mps2, 0.05, 10.0);
    reader.Field("stamped", stamped);
    reader.Field("heading_tolerance_rad", heading_tolerance_rad, 0.01, 0.5);
    reader.Field("stuck_s", stuck_s, 1.0, 600.0);
    reader.Field("blocked_for_s", blocked_for_s, 1.0, 3600.0);
    reader.Field("clearance_m", clearance_m, 0.0, 5.0);
    reader.Field("wait_s", wait_s, 0.0, 60.0);
  }
};

/// When its place is lost: silence, wall time, or a jump that it cannot have driven.
struct LocalisationConfig {
  double timeout_s = 1.0;             // of odometry
  double correction_timeout_s = 5.0;  // of TF from the map's frame to odometry's
  double jump_m = 0.5;
  double jump_deg = 35.0;
  double settle_s = 2.0;  // after a jump

  void Visit(ConfigReader& reader) {
    reader.Field("timeout_s", timeout_s, 0.1, 60.0);
    reader.Field("correction_timeout_s", correction_timeout_s, 0.1, 600.0);
    reader.Field("jump_m", jump_m, 0.05, 100.0);
    reader.Field("jump_deg", jump_deg, 1.0, 180.0);
    reader.Field("settle_s", settle_s, 0.0, 60.0);
  }
};

struct RobotMapConfig {
  /// Values of the robot's map: free up to, occupied from; between them unknown.
  int free_up_to = 25;
  int occupied_from = 65;
  /// 0 for a map that is published once.
  double timeout_s = 15.0;
  /// False for a map whose publisher is not transient local.
  bool latched = true;

  void Visit(ConfigReader& reader) {
    reader.Field("free_up_to", free_up_to, 0, 99);
    reader.Field("occupied_from", occupied_from, 1, 100);
    reader.Field("timeout_s", timeout_s, 0.0, 3600.0);
    reader.Field("latched", latched);
  }
};

/// Where the camera is on the robot, and how far its pictures show walls.
struct RobotCameraConfig {
  double range_m = 5.0;
  double forward_m = 0.1;
  double height_m = 0.5;
  double pitch_deg = 0.0;  // downwards
  /// How old a picture may be when it comes: it counts from so long after the turn.
  double latency_s = 0.3;
  double timeout_s = 5.0;
  int jpeg_quality = 85;
  /// With topics.pan: the joint's range, counter-clockwise from straight ahead, and how long it takes.
  double pan_least_deg = -90.0;
  double pan_most_deg = 90.0;
  double pan_settle_s = 1.5;

  void Visit(ConfigReader& reader) {
    reader.Field("range_m", range_m, 0.1, 1000.0);
    reader.Field("forward_m", forward_m, -5.0, 5.0);
    reader.Field("height_m", height_m, 0.0, 10.0);
    reader.Field("pitch_deg", pitch_deg, 0.0, 60.0);
    reader.Field("latency_s", latency_s, 0.0, 10.0);
    reader.Field("timeout_s", timeout_s, 0.5, 60.0);
    reader.Field("jpeg_quality", jpeg_quality, 1, 100);
    reader.Field("pan_least_deg", pan_least_deg, -180.0, 0.0);
    reader.Field("pan_most_deg", pan_most_deg, 0.0, 180.0);
    reader.Field("pan_settle_s", pan_settle_s, 0.0, 10.0);
  }
};

/// Section `driver`: a robot that speaks only ROS 2, as conav's robot `robot` (docs/robots.md).
struct DriverConfig {
  bus::ParticipantOptions bus;
  std::string world = "w1";
  std::string robot = "r1";
  /// ROS 2 name space of the robot's own topics; empty = none.
  std::string robot_namespace;
  RobotTopicsConfig topics;
  FramesConfig frames;
  AlignmentConfig alignment;
  MoveConfig move;
  LocalisationConfig localisation;
  RobotMapConfig map;
  RobotCameraConfig camera;
  /// conav's other robots in the world, for the right of way.
  std::vector<std::string> others;
  /// The robot's time is /clock: in a world with a simulator.
  bool use_sim_time = false;
  /// Keeps whether the robot is stopped, by which order, and the lease epoch over a restart; empty =
  /// forgotten.
  std::string state_file;

  void Visit(ConfigReader& reader) {
    reader.Section("bus", bus);
    reader.Field("world", world);
    reader.Field("robot", robot);
    reader.Field("namespace", robot_namespace);
    reader.Section("topics", topics);
    reader.Section("frames", frames);
    reader.Section("alignment", alignment);
    reader.Section("move", move);
    reader.Section("localisation", localisation);
    reader.Section("map", map);
    reader.Section("camera", camera);
    reader.Field("others", others);
    reader.Field("use_sim_time", use_sim_time);
    reader.Field("state_file", state_file);
  }
};

}  // namespace conav::robot
