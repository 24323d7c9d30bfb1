#include "common/service/service_main.h"
#include "sim/sim_service.h"

/// conav-sim: one world with its robots, cameras and clock.
int main(int argc, char** argv) {
  return conav::RunServiceMain<conav::sim::SimConfig, conav::sim::SimService>(
      "sim",
      "Simulates one world in MuJoCo: a maze or the map of a building, robots that drive by "
      "command, their\n"
      "cameras, and what each of them has seen.",
      argc, argv, [](const conav::sim::SimConfig& config) { return "sim_" + config.world; });
}
