#pragma once

#include <cstdint>
#include <string>
#include <utility>

#include "common/bus/service.h"

// One user: SimService.

namespace conav::sim {

/// The ROS 2 services of one simulated world: pause (or go on), step while paused, reset.
/// Threads: one.
class SimulationServices {
 public:
  /// Most steps that one request may ask for.
  static constexpr std::uint32_t kMostSteps = 4800;  // 20 minutes of simulation time

  SimulationServices(bus::Participant& participant, const std::string& world)
      : pause_(participant, bus::kPauseService, world),
        step_(participant, bus::kStepService, world),
        reset_(participant, bus::kResetService, world) {}

  /// Answers what was asked.
  void Turn();

  bool paused() const { return paused_; }
  /// While paused: whether one more step was asked for.
  bool TakeStep() { return steps_ > 0 && steps_-- > 0; }
  bool TakeReset() { return std::exchange(reset_asked_, false); }

 private:
  conav_msgs::srv::StepSimulation_Response Step(std::uint32_t steps);

  bus::ServiceServer<std_srvs::srv::SetBool_Request, std_srvs::srv::SetBool_Response> pause_;
  bus::ServiceServer<conav_msgs::srv::StepSimulation_Request,
                     conav_msgs::srv::StepSimulation_Response>
      step_;
  bus::ServiceServer<std_srvs::srv::Trigger_Request, std_srvs::srv::Trigger_Response> reset_;
  bool paused_ = false;
  std::uint32_t steps_ = 0;
  bool reset_asked_ = false;
};

}  // namespace conav::sim
