#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "common/bus/service.h"
#include "common/runtime/clock.h"
#include "operator/console/console_topics.h"
#include "operator/supervision/control.h"

// One user: the operator service.

namespace conav::operators {

/// Writes a map as ROS 2's map_server reads it, FOLDER/NAME.yaml and NAME.pgm, each whole or not at
/// all: free cells white, walls black, others grey. Row 0 of the picture is the northern one.
/// Errors: kOutOfRange (the name is no plain name), those of WriteFile.
[[nodiscard]] Result<void> SaveMap(const nav_msgs::msg::OccupancyGrid& map,
                                   const std::filesystem::path& folder, const std::string& name);

/// The operator's ROS 2 services: stop and resume of each robot, which are requests of the client
/// "ros2" (it may not resume a robot that another client has control of), and a map of each world on
/// disk, in the folder of the database.
/// Threads: one.
class RosServices {
 public:
  static constexpr const char* kClient = "ros2";

  /// `participant` outlives it.
  RosServices(bus::Participant& participant,
              const std::map<std::string, std::string>& world_of_robot,
              std::filesystem::path map_folder);
  ~RosServices();

  /// Requests since the last call, answered by their reply. Saves maps; blocks on the disk.
  std::vector<ConsoleTopics::Asked> Step(const ControlRegistry& control, Clock::TimePoint now);

 private:
  struct Robot;
  struct World;

  std::filesystem::path map_folder_;
  std::uint64_t newest_request_;
  std::vector<std::unique_ptr<Robot>> robots_;
  std::vector<std::unique_ptr<World>> worlds_;
};

}  // namespace conav::operators
