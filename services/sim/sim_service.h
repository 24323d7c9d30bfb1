#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/bus/publisher.h"
#include "common/bus/subscriber.h"
#include "common/runtime/clock.h"
#include "common/runtime/threads.h"
#include "common/service/diagnostics.h"
#include "sim/config.h"
#include "sim/physics/camera.h"
#include "sim/world/episode.h"
#include "sim/world/world_spec.h"

namespace conav::sim {

/// The topics of one robot, and what has been published on them.
///
/// Publishes map, state, camera_info, odom and tf before the first command; then whenever they
/// change. The state is published at least twice per second of simulation time, so that its newest
/// stamp tells others what time it is while the robot waits.
class RobotTopics {
 public:
  RobotTopics(bus::Participant& participant, const std::string& robot);

  /// State and map if they changed since the last call; a state that has become a second old.
  void PublishChanges(const Episode& episode, int robot);
  /// Pose on odom and tf.
  void PublishPose(const Episode& episode, int robot);
  void PublishCameraInfo(SimTime stamp, int width, int height);
  /// Whether anybody takes the frames.
  bool has_viewers() const { return frame_.matched_subscribers() > 0; }
  void PublishFrame(SimTime stamp, const std::vector<std::uint8_t>& jpeg);
  void Publish(const Snapshot& picture);

  std::vector<RobotCommand> TakeCommands();
  const std::string& robot() const { return robot_; }

 private:
  std::string robot_;
  bus::Publisher<conav_msgs::msg::RobotState> state_;
  bus::Publisher<nav_msgs::msg::OccupancyGrid> map_;
  bus::Publisher<nav_msgs::msg::Odometry> odometry_;
  bus::Publisher<tf2_msgs::msg::TFMessage> transforms_;
  bus::Publisher<conav_msgs::msg::Snapshot> snapshot_;
  bus::Publisher<sensor_msgs::msg::CompressedImage> frame_;
  bus::Publisher<sensor_msgs::msg::CameraInfo> camera_info_;
  bus::Subscriber<conav_msgs::msg::RobotCommand> command_;
  std::uint64_t state_version_ = 0;
  SimTime state_stamp_;
  SimTime map_stamp_{-1};
};

/// One world on the bus: owns the truth, moves the robots, takes their pictures.
///
/// Before the first command it publishes /clock (unless told not to), truth, initial map, goals and
/// each robot's map and state. Stale input: commands of an older lease or sequence are refused and
/// logged; a command past its expiry is void, and a robot without a command in force stands still.
class SimService {
 public:
  /// Throws StartupError: impossible world, unreadable map, no usable EGL.
  SimService(bus::Participant& participant, const SimConfig& config, const Clock& clock);
  ~SimService();

  /// Blocks until `stop`. The camera's OpenGL context belongs to the thread that built the service.
  void Run(const StopToken& stop);
  /// One turn of Run: takes commands, moves time on if it is due, publishes. False = nothing to do
  /// now.
  bool Turn();

 private:
  void BuildWorld();
  void PublishWorld();
  /// When goals have been reached since the last call.
  void PublishGoals();
  void PublishClock();
  void TakeCommands();
  Result<void> Accept(const RobotCommand& command, const std::string& robot);
  bool StepDue();
  void Step();
  void TakeSnapshots(const std::vector<std::uint64_t>& steps_before);
  void StreamSnapshot(int robot);
  /// Frames of robots that stand, for those who look on: frames are not latched, and whoever comes
  /// late would see none. They belong to no low-level step and are not counted.
  void StreamAtRest();
  std::vector<std::uint8_t> RenderJpeg(int robot);
  /// As seen from the centre of its cell, or from `robot`'s own position.
  void Fill(Snapshot& picture) const;
  void FillFrom(int robot, Snapshot& picture) const;
  void Fill(Snapshot& picture, const CameraView& view) const;
  Health Report() const;

  bus::Participant& participant_;
  SimConfig config_;
  const Clock& clock_;
  WorldSpec spec_;
  std::unique_ptr<RobotWorld> physics_;
  std::unique_ptr<Episode> episode_;
  std::unique_ptr<Camera> camera_;  // absent with camera.mode none
  std::vector<std::unique_ptr<RobotTopics>> robots_;
  std::vector<Clock::TimePoint> frame_sent_at_;  // by robot
  bus::Publisher<nav_msgs::msg::OccupancyGrid> truth_;
  bus::Publisher<nav_msgs::msg::OccupancyGrid> initial_map_;
  bus::Publisher<visualization_msgs::msg::MarkerArray> goals_;
  std::optional<bus::Publisher<rosgraph_msgs::msg::Clock>> clock_topic_;  // unless another sim's
  Diagnostics diagnostics_;
  Clock::TimePoint next_step_{};
  std::uint64_t refused_commands_ = 0;
  int goals_published_ = -1;  // how many the last markers showed
};

}  // namespace conav::sim
