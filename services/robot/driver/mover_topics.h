#pragma once

#include <functional>
#include <memory>
#include <string>

#include "common/bus/participant.h"
#include "robot/driver/config.h"
#include "robot/driver/mover.h"

namespace conav::robot {

/// The full name of a topic or action of the robot; empty stays empty. Throws StartupError, naming `key`,
/// for a name that conav itself uses for this robot.
std::string RobotTopicName(const DriverConfig& config, const std::string& key,
                           const std::string& name);

/// The way that `config.move.by` names, on the bus. Throws StartupError: its topic has no name.
std::unique_ptr<Mover> MakeMover(bus::Participant& participant, const DriverConfig& config,
                                 const Pose& plan_from_robot);

/// Sends the angle of the camera's joint; empty if it has none.
std::function<void(double)> MakePan(bus::Participant& participant, const DriverConfig& config);

}  // namespace conav::robot
