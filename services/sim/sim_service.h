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

// One user: main starts it; tests build it whole.

namespace conav::sim {

/// The topics of one robot, and their last published state.
///
/// Publishes map, goals, state, camera_info, odom and tf before the first command, then on every change.
/// Publishes the state at least twice per second of simulation time, so that its newest stamp shows
/// the time while the robot waits.
class RobotTopics {
 public:
  RobotTopics(bus::Participant& participant, const std::string& robot);

  /// Publishes state, goals and map if they changed since the last call, and a state that is due again.
  void PublishChanges(const Episode& episode, int robot);
  /// Publishes the pose on odom and tf.
  void PublishPose(const Episode& episode, int robot);
  void PublishCameraInfo(SimTime stamp, int width, int height);
  /// Whether anybody subscribes to the frames.
  bool has_viewers() const { return frame_.matched_subscribers() > 0; }
  void PublishFrame(SimTime stamp, const std::vector<std::uint8_t>& jpeg);
  void Publish(const Snapshot& snapshot);

  std::vector<StopOrder> TakeStopOrders();
  std::vector<RobotCommand> TakeCommands();
  const std::string& robot() const { return robot_; }

 private:
  bus::Participant& participant_;
  std::string robot_;
  bus::Publisher<conav_msgs::msg::RobotState> state_;
  /// Of robots that keep their goals.
  std::optional<bus::Publisher<conav_msgs::msg::RobotGoals>> robot_goals_;
  bus::Publisher<nav_msgs::msg::OccupancyGrid> map_;
  bus::Publisher<nav_msgs::msg::Odometry> odometry_;
  bus::Publisher<tf2_msgs::msg::TFMessage> transforms_;
  bus::Publisher<conav_msgs::msg::Snapshot> snapshot_;
  bus::Publisher<sensor_msgs::msg::CompressedImage> frame_;
  bus::Publisher<sensor_msgs::msg::CameraInfo> camera_info_;
  bus::Subscriber<conav_msgs::msg::RobotCommand> command_;
  bus::Subscriber<conav_msgs::msg::StopOrder> stop_;
  std::uint64_t state_version_ = 0;
  SimTime state_stamp_;
  SimTime map_stamp_{-1};
  SimTime goals_stamp_;
};

/// One world on the bus: owns the truth, moves the robots, takes their pictures.
///
/// Before the first command it publishes /clock (unless disabled), truth, initial map, goals and
/// each robot's map and state. Stale input: it rejects and logs commands of an older lease or
/// sequence; a command past its expiry is void, and a robot without a command in force stands
/// still.
class SimService {
 public:
  /// Throws StartupError: impossible world, unreadable map, no usable EGL.
  SimService(bus::Participant& participant, const SimConfig& config, const Clock& clock);
  ~SimService();

  /// Blocks until `stop`. Call it on the thread that built the service: the OpenGL context belongs
  /// to it.
  void Run(const StopToken& stop);
  /// One iteration of Run: takes commands, advances time if due, publishes. False = nothing to do
  /// now.
  bool Turn();

 private:
  RobotTopics& TopicsOf(int robot) { return *robots_[static_cast<std::size_t>(robot)]; }
  void BuildWorld();
  void PublishWorld();
  /// Publishes when doors closed since the last call.
  void PublishTruth();
  /// Publishes when robots reached goals since the last call.
  void PublishGoals();
  void PublishClock();
  void TakeCommands();
  Result<void> Accept(const RobotCommand& command, const std::string& robot);
  bool StepDue();
  void Step();
  void TakeSnapshots(const std::vector<std::uint64_t>& steps_before);
  void StreamSnapshot(int robot);
  /// Streams frames that belong to no low-level step while somebody watches: in methods that stream,
  /// of robots that stand still, because frames are not latched and a late viewer would see none; in
  /// the others at camera.live_hz.
  void StreamToViewers();
  std::vector<std::uint8_t> RenderJpeg(int robot);
  /// Fills in the view from the centre of its cell, or from `robot`'s own position.
  void Fill(Snapshot& snapshot) const;
  void FillFrom(int robot, Snapshot& snapshot) const;
  void Fill(Snapshot& snapshot, const CameraView& view) const;
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
  // empty if another sim publishes it
  std::optional<bus::Publisher<rosgraph_msgs::msg::Clock>> clock_topic_;
  Diagnostics diagnostics_;
  Clock::TimePoint next_step_{};
  std::uint64_t refused_commands_ = 0;
  int doors_published_ = -1;  // closed in the last truth
  int goals_published_ = -1;  // goals left in the last markers
};

}  // namespace conav::sim
