#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/bus/changes.h"
#include "common/bus/publisher.h"
#include "common/bus/subscriber.h"
#include "common/runtime/clock.h"
#include "common/runtime/threads.h"
#include "common/service/diagnostics.h"
#include "common/service/robot_state_topics.h"
#include "robot/driver/config.h"
#include "robot/driver/driver.h"
#include "robot/driver/localisation.h"
#include "robot/driver/robot_topics.h"

// One user: main starts it; tests build it whole.

namespace conav::robot {

/// One ROS 2 robot on the bus as a robot of conav.
///
/// Publishes nothing before /<world>/initial_map, whose cells are its map's, and before it knows its place
/// and its map; /diagnostics and the log say what it waits for. Then its map, its state at least every
/// 0.25 s, and camera_info as soon as the robot's own came. Stale input: the robot stands while its place,
/// its map or the way to move is missing, and goes on when it is back.
class DriverService {
 public:
  /// Throws StartupError: names, or pairs of points that do not fit.
  DriverService(bus::Participant& participant, const DriverConfig& config, const Clock& clock);

  /// Blocks until `stop`; then the robot stands.
  void Run(const StopToken& stop);
  /// One iteration of Run.
  void Turn();

 private:
  void TakeTime();
  void TakeInputs();
  void TakeOthers();
  void TakePicture();
  void Publish();
  void NoteProblem();
  /// Writes to config.state_file what outlives the program, when it has changed.
  void Keep();
  Health Report() const;

  bus::Participant& participant_;
  DriverConfig config_;
  const Clock& clock_;
  Alignment alignment_;
  RobotTopics robot_;
  Localisation localisation_;
  Driver driver_;
  RobotStatePublisher states_;
  bus::ChangesPublisher<nav_msgs::msg::OccupancyGrid> maps_;
  bus::Publisher<conav_msgs::msg::Snapshot> snapshots_;
  bus::Publisher<sensor_msgs::msg::CameraInfo> camera_info_;
  bus::Subscriber<conav_msgs::msg::RobotCommand> commands_;
  bus::Subscriber<conav_msgs::msg::StopOrder> stops_;
  bus::Subscriber<nav_msgs::msg::OccupancyGrid> initial_map_;
  std::optional<bus::Subscriber<rosgraph_msgs::msg::Clock>> clock_topic_;
  std::map<std::string, std::unique_ptr<bus::Subscriber<conav_msgs::msg::RobotState>>> others_;
  std::map<std::string, RobotState> other_states_;
  Diagnostics diagnostics_;
  SimTime now_;
  Clock::TimePoint time_taken_at_{};
  bool has_time_ = false;
  Clock::TimePoint next_step_{};
  Clock::TimePoint next_state_{};
  std::optional<RobotState> sent_;
  std::optional<CameraLens> lens_;
  std::string problem_;
  std::string kept_;      // in the state file
  std::string not_kept_;  // why it is not up to date; empty = it is
  Clock::TimePoint keep_due_at_{};
  std::uint64_t refused_commands_ = 0;
};

}  // namespace conav::robot
