#pragma once

#include <atomic>
#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "common/bus/participant.h"

namespace conav::test {

/// A building, metres: solid boxes on a floor whose corner is (x0, y0).
struct Building {
  struct Box {
    double x0, y0, x1, y1;
  };
  std::vector<Box> walls;

  bool IsWall(double x, double y) const;
  /// Whether a disc touches a wall.
  bool Touches(double x, double y, double radius) const;
  /// How far a ray goes from (x, y), `range` at most.
  double Ray(double x, double y, double yaw, double range) const;
};

/// A robot as ROS 2's own documents describe one: REP-103 (axes), REP-105 (map -> odom -> base_link),
/// nav_msgs (a SLAM's growing grid, row-major from its origin, transient local), sensor_msgs (images
/// and camera_info), geometry_msgs/Twist on cmd_vel with the time-out of a base, a goal_pose follower, and
/// nav2_msgs' NavigateToPose with one goal at a time: a newer one replaces it.
/// It knows nothing of conav.
///
/// A differential drive of 0.2 m radius whose odometry drifts; its SLAM corrects that once a second. Its map
/// begins where it started, in a frame of its own, and grows.
class StandinRobot {
 public:
  struct Options {
    std::string name;                    // its ROS 2 name space
    double x = 0.0, y = 0.0, yaw = 0.0;  // where it starts, in the building
    double map_resolution = 0.07;
    bool prefixed_frames =
        false;                   // frames "tb3/base_link" on /tf, instead of plain ones on /tb3/tf
    bool raw_image = false;      // and depth, instead of JPEG
    bool follows_goals = false;  // goal_pose instead of cmd_vel
    bool navigates = false;      // the action NavigateToPose instead of cmd_vel
    bool stamped = false;        // TwistStamped
    bool has_pan = false;
  };
  /// Things that go wrong.
  struct Faults {
    std::atomic<bool> odometry_silent{false};
    std::atomic<bool> correction_silent{false};
    std::atomic<bool> map_silent{false};
    std::atomic<bool> camera_silent{false};
    std::atomic<bool> wheels_blocked{false};
    std::atomic<bool> aborts{false};     // its navigation ends each goal at once
    std::atomic<bool> base_gone{false};  // no cmd_vel, goal_pose or action server
    std::atomic<bool> jumps{false};      // once: the SLAM believes itself 3 m away, for 1.5 s
  };
  struct Place {
    double x, y, yaw;
  };

  StandinRobot(const bus::ParticipantOptions& bus, const Building& building,
               const Options& options);
  ~StandinRobot();

  /// Where it is in the building.
  Place place() const;
  /// Times that it ran into a wall.
  int bumps() const { return bumps_; }
  int goals_received() const { return goals_received_; }
  double pan() const { return pan_; }
  Faults faults;

 private:
  struct Topics;
  struct Map;

  void Run();
  void Step(double seconds);
  void Move(double seconds);
  void Follow();
  void Navigate();
  void Scan();
  void SendPose();
  void SendMap();
  void SendPicture();

  const Building& building_;
  Options options_;
  bus::ParticipantOptions bus_;
  std::unique_ptr<Topics> topics_;
  std::unique_ptr<Map> map_;
  mutable std::atomic<double> x_, y_, yaw_;
  std::atomic<int> bumps_{0};
  std::atomic<int> goals_received_{0};
  std::atomic<double> pan_{0.0};
  double forward_ = 0.0, turn_ = 0.0;  // as commanded
  double speed_ = 0.0, rate_ = 0.0;    // as it moves
  std::chrono::steady_clock::time_point commanded_at_{};
  Place odom_{0.0, 0.0, 0.0};  // as its wheels believe, from its start
  Place map_from_odom_{0.0, 0.0, 0.0};
  std::optional<Place> goal_;  // in its map's frame
  std::chrono::steady_clock::time_point jumped_until_{};
  int ticks_ = 0;
  bool touched_ = false;
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

}  // namespace conav::test
