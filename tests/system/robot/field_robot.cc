// A robot that is not the simulator's, for the browser's journeys: field_robot <domain>.
#include "system/robot/field_robot.h"

#include <cstdlib>
#include <iostream>

#include "common/runtime/threads.h"

int main(int argc, char** argv) {
  if (argc != 2) {
    std::cerr << "usage: field_robot <domain>\n";
    return 2;
  }
  conav::InstallStopSignals();
  try {
    conav::bus::ParticipantOptions options;
    options.domain_id = std::atoi(argv[1]);
    options.interface = "lo";
    conav::test::FieldRobot robot(options);
    while (!conav::ProcessStopToken().stop_requested()) robot.Step();
    return 0;
  } catch (const std::exception& error) {
    std::cerr << "field_robot: " << error.what() << "\n";
    return 1;
  }
}
