#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "operator/operator_service.h"

/// Parts of operator_service*.cc only: the topics of one world, and those of one robot.
namespace conav::operators {

struct OperatorService::WorldLink {
  WorldLink(bus::Participant& participant, const std::string& name)
      : name(name), initial_map(participant, bus::kInitialMap, name) {}

  bool served() const { return belief.has_value(); }

  std::string name;
  bus::Subscriber<nav_msgs::msg::OccupancyGrid> initial_map;
  std::optional<bus::Publisher<conav_msgs::msg::BeliefMap>> belief;  // while it is served
  std::optional<bus::Publisher<nav_msgs::msg::OccupancyGrid>> belief_map;
  double cell_size_m = 0.0;
  BeliefGrid initial;                // while it is served
  std::optional<MapUpdate> pending;  // initial map that is not stored yet
  std::string refusal;               // why the newest initial map is not served; empty otherwise
};

struct OperatorService::RobotLink {
  RobotLink(bus::Participant& participant, const std::string& name, const std::string& world)
      : name(name),
        world(world),
        state(participant, bus::kRobotState, name),
        attention(participant, bus::kAttention, name),
        drive(participant, bus::kDriveOrder, name) {}

  std::string name;
  std::string world;
  bus::Subscriber<conav_msgs::msg::RobotState> state;
  bus::Subscriber<conav_msgs::msg::AttentionRequest> attention;
  bus::Publisher<conav_msgs::msg::DriveOrder> drive;
  std::optional<bus::Publisher<conav_msgs::msg::Guidance>> guidance;  // while its world is served
  std::optional<SimTime> stamp;                                       // of the newest state
  std::optional<RobotState> first_state;  // of a run that was not greeted yet
  std::uint64_t asked = 0;                // attention requests heard
};

}  // namespace conav::operators
