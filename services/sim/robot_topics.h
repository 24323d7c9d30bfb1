#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/bus/changes.h"
#include "common/bus/publisher.h"
#include "common/bus/subscriber.h"
#include "common/service/robot_state_topics.h"
#include "sim/world/episode.h"

// One user: the service, which with its robots' topics would be two things in one file.

namespace conav::sim {

/// The topics of one robot but for those of its motion (MotionTopics), and their last published
/// state.
///
/// Publishes map, goals, state, camera_info and robot_description before the first command, then on
/// every change. Publishes the state at least twice per second of simulation time, so that its
/// newest stamp shows the time while the robot waits, and once per second of wall time, so that silence
/// means that the simulator is gone.
class RobotTopics {
 public:
  /// Width and height of its images in pixels.
  RobotTopics(bus::Participant& participant, const std::string& robot, int width, int height);

  /// For a world that starts again: publishes all as at the start, and drops commands that wait.
  void Restart();

  /// Publishes state, goals and map if they changed since the last call, and a state that is due
  /// again.
  void PublishChanges(const Episode& episode, int robot, Clock::TimePoint now);
  void PublishDescription(const std::string& urdf);
  void PublishCameraInfo(SimTime stamp);
  /// Whether anybody subscribes to the frames.
  bool has_viewers() const { return frame_.matched_subscribers() > 0; }
  /// The camera_info of the same stamp goes before it.
  void PublishFrame(SimTime stamp, const std::vector<std::uint8_t>& jpeg);
  void Publish(const Snapshot& snapshot);

  std::vector<StopOrder> TakeStopOrders();
  std::vector<RobotCommand> TakeCommands();
  const std::string& robot() const { return robot_; }

 private:
  bus::Participant& participant_;
  std::string robot_;
  int width_;
  int height_;
  RobotStatePublisher state_;
  /// Of robots that keep their goals.
  std::optional<bus::Publisher<conav_msgs::msg::RobotGoals>> robot_goals_;
  bus::ChangesPublisher<nav_msgs::msg::OccupancyGrid> map_;
  bus::Publisher<conav_msgs::msg::Snapshot> snapshot_;
  bus::Publisher<sensor_msgs::msg::CompressedImage> frame_;
  bus::Publisher<sensor_msgs::msg::CameraInfo> camera_info_;
  bus::Publisher<std_msgs::msg::String> description_;
  bus::Subscriber<conav_msgs::msg::RobotCommand> command_;
  bus::Subscriber<conav_msgs::msg::StopOrder> stop_;
  std::uint64_t state_version_ = 0;
  SimTime state_stamp_;
  Clock::TimePoint state_sent_at_{};
  SimTime map_stamp_{-1};
  SimTime goals_stamp_;
};

}  // namespace conav::sim
