#pragma once

#include <deque>
#include <string>
#include <vector>

#include "common/grid/geometry.h"
#include "common/protocol/robot.h"

namespace conav::sim {

/// What the simulator keeps of one robot besides its physics.
struct RobotRecord {
  RobotState state;       // as it will be published; stamp is filled in then
  MapUpdate map;          // what this robot has seen
  RobotCommand command;   // the last one taken up
  bool active = false;    // a command is in force
  bool braking = false;   // ended early, still rolling
  bool coasting = false;  // a drive action ended, still rolling: brakes when time goes on
  Position position;      // of the axis when its cells were looked at last
  CommandOutcome drive_outcome = CommandOutcome::kNone;  // of the drive action in force
  std::string drive_detail;
  std::deque<Cell> waypoints;  // cell centres still to be driven to, the command's target last
  std::vector<Cell> reserved;  // cells that no other robot may enter
};

}  // namespace conav::sim
