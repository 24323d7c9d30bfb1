#pragma once

#include <cstdint>
#include <string>

#include "common/bus/publisher.h"
#include "common/bus/subscriber.h"
#include "sim/episode/episode.h"

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
  void Publish(const Picture& picture);

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

}  // namespace conav::sim
