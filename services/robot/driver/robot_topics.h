#pragma once

#include <memory>
#include <optional>
#include <string>

#include "common/bus/publisher.h"
#include "common/bus/subscriber.h"
#include "common/msg/convert.h"
#include "common/runtime/clock.h"
#include "common/runtime/log.h"
#include "robot/driver/config.h"
#include "robot/driver/localisation.h"
#include "robot/driver/map_keeper.h"
#include "robot/driver/view.h"

// One user: the driver's service; why it is apart: here ends what the robot says in ROS 2's terms.

namespace conav::robot {

/// The topics of the robot itself: foreign names, foreign messages. Values that are no numbers are
/// dropped with a warning. Threads: one caller.
class RobotTopics {
 public:
  /// Throws StartupError: a name that is empty where it must not be, or conav's own.
  RobotTopics(bus::Participant& participant, const DriverConfig& config,
              const Pose& plan_from_robot);
  ~RobotTopics();

  /// Takes what came.
  void Receive(Clock::TimePoint now);

  /// The robot in the frame of its own map; nothing without a chain of frames.
  std::optional<FrameTree::Found> place() const;
  /// How far the correction of its map has moved it from where odometry alone puts it since the start;
  /// nothing where odometry is not a frame of its own.
  std::optional<Pose> drift() const;
  double speed_mps() const { return speed_mps_; }
  double turn_rps() const { return turn_rps_; }

  /// What came since the last call.
  std::optional<RobotMap> TakeMap();
  std::optional<CameraLens> TakeLens(sensor_msgs::msg::CameraInfo& message);
  /// The newest picture if it came at `since` or later. Errors: kMalformed.
  std::optional<Result<Picture>> PictureSince(Clock::TimePoint since, int jpeg_quality) const;
  /// The newest depth image that came then; empty if none did.
  DepthProfile DepthSince(Clock::TimePoint since) const;

 private:
  struct Inputs;

  void Take(const nav_msgs::msg::Odometry& message, Clock::TimePoint now);
  void Take(const tf2_msgs::msg::TFMessage& message, bool fixed, Clock::TimePoint now);
  std::optional<RobotMap> Placed(nav_msgs::msg::OccupancyGrid message);

  DriverConfig config_;
  Pose plan_from_robot_;
  std::unique_ptr<Inputs> inputs_;
  FrameTree frames_;
  std::optional<Pose> first_map_from_odom_;
  double speed_mps_ = 0.0;
  double turn_rps_ = 0.0;
  LogLimit warnings_;
};

}  // namespace conav::robot
