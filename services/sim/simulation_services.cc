#include "sim/simulation_services.h"

#include <fmt/core.h>

#include "common/runtime/log.h"
#include "sim/physics/world_model.h"

namespace conav::sim {

void SimulationServices::Turn() {
  pause_.Serve([this](const std_srvs::srv::SetBool_Request& request) {
    if (paused_ != request.data()) LOG_INFO("simulation", "paused", request.data());
    paused_ = request.data();
    steps_ = 0;
    std_srvs::srv::SetBool_Response response;
    response.success(true);
    response.message(paused_ ? "paused" : "running");
    return response;
  });
  step_.Serve([this](const conav_msgs::srv::StepSimulation_Request& request) {
    return Step(request.steps());
  });
  reset_.Serve([this](const auto&) {
    reset_asked_ = true;
    std_srvs::srv::Trigger_Response response;
    response.success(true);
    response.message("the world starts again");
    return response;
  });
}

conav_msgs::srv::StepSimulation_Response SimulationServices::Step(std::uint32_t steps) {
  conav_msgs::srv::StepSimulation_Response response;
  if (!paused_) {
    response.message("the simulation is not paused");
  } else if (steps == 0 || steps > kMostSteps) {
    response.message(fmt::format("steps = {} is not in [1, {}]", steps, kMostSteps));
  } else {
    steps_ = steps;
    response.success(true);
    response.message(fmt::format("advances by {} s", steps * kControlStepS));
  }
  return response;
}

}  // namespace conav::sim
