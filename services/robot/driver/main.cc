#include "common/service/service_main.h"
#include "robot/driver/driver_service.h"

/// conav-driver: one ROS 2 robot as a robot of conav.
int main(int argc, char** argv) {
  return conav::RunServiceMain<conav::robot::DriverConfig, conav::robot::DriverService>(
      "driver",
      "Makes a ROS 2 robot with standard topics a robot of conav: odometry or TF, an OccupancyGrid "
      "of a\n"
      "SLAM or a costmap, a camera, and cmd_vel or goal_pose to move it. docs/robots.md tells how "
      "to\n"
      "align its map with the operator's plan, and what it does when something is lost.",
      argc, argv,
      [](const conav::robot::DriverConfig& config) { return "driver_" + config.robot; });
}
