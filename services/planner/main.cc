#include "common/service/service_main.h"
#include "planner/planner_service.h"

/// conav-planner: decides for its robots what they do next.
int main(int argc, char** argv) {
  return conav::RunServiceMain<conav::planner::PlannerConfig, conav::planner::PlannerService>(
      "planner",
      "Drives robots by IG-MCTS, instruction following, teleoperation or greedily: listens to each "
      "robot's state and map\n"
      "and to the operator's map and guidance, and sends commands.",
      argc, argv, [](const conav::planner::PlannerConfig& config) { return config.name; },
      [](conav::planner::PlannerConfig& config, const std::string& name) {
        config.search = conav::planner::SearchFrom(name);
      });
}
