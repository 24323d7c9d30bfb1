// ROS 2 services of the simulator, with real MuJoCo.
#include <catch2/catch.hpp>

#include "common/bus/service.h"
#include "integration/sim/sim_harness.h"

namespace conav::sim {
namespace {

template <class Request, class Response>
Response Ask(SimHarness& sim, const bus::Service<Request, Response>& service, Request request) {
  bus::ServiceClient<Request, Response> client(sim.peer(), service.NameFor("w1"));
  REQUIRE(client.Call(std::move(request)));
  sim.Turn();
  const auto replies = client.Take();
  REQUIRE(replies.size() == 1);
  return replies[0].response;
}

std_srvs::srv::SetBool_Request Pause(bool pause) {
  std_srvs::srv::SetBool_Request request;
  request.data(pause);
  return request;
}

conav_msgs::srv::StepSimulation_Request Steps(std::uint32_t steps) {
  conav_msgs::srv::StepSimulation_Request request;
  request.steps(steps);
  return request;
}

TEST_CASE("a paused simulation stands, advances by the steps asked for, and goes on",
          "[sim][service]") {
  SimHarness sim(BlindConfig());
  CHECK_FALSE(Ask(sim, bus::kStepService, Steps(2)).success());
  CHECK(Ask(sim, bus::kPauseService, Pause(true)).success());
  const RobotCommand command =
      sim.robot().Move(sim.NeighbourThatIs(Occupancy::kFree, sim.robot().state().cell));
  sim.robot().Send(command);
  sim.Settle();
  const SimTime paused_at = sim.robot().state().stamp;
  CHECK(sim.robot().state().command_outcome == CommandOutcome::kRunning);

  CHECK_FALSE(Ask(sim, bus::kStepService, Steps(0)).success());
  CHECK_FALSE(Ask(sim, bus::kStepService, Steps(SimulationServices::kMostSteps + 1)).success());
  CHECK(Ask(sim, bus::kStepService, Steps(4)).success());
  sim.Settle();
  CHECK(sim.robot().state().stamp.ToSeconds() - paused_at.ToSeconds() == Approx(1.0));
  CHECK(sim.robot().state().command_outcome == CommandOutcome::kRunning);

  CHECK(Ask(sim, bus::kPauseService, Pause(false)).success());
  sim.Settle();
  CHECK(sim.robot().state().command_outcome == CommandOutcome::kDone);
}

TEST_CASE("reset starts the world again: place, goals and time", "[sim][service]") {
  SimHarness sim(BlindConfig());
  const RobotState start = sim.robot().state();
  REQUIRE(sim.Step() == CommandOutcome::kDone);
  REQUIRE(sim.robot().state().cell != start.cell);
  CHECK(Ask(sim, bus::kResetService, {}).success());
  sim.Turn();
  CHECK(sim.robot().state().cell == start.cell);
  CHECK(sim.robot().state().stamp == start.stamp);
  CHECK(sim.robot().state().goals_left == start.goals_left);
  CHECK(sim.robot().state().command_outcome == CommandOutcome::kNone);
  CHECK(sim.Step() == CommandOutcome::kDone);
}

TEST_CASE("the speed changes while the simulation runs", "[sim][service]") {
  SimConfig config = BlindConfig();
  config.speed = 1.0;
  SimHarness sim(config);
  const auto steps_in = [&](std::chrono::milliseconds time) {
    sim.clock.Advance(time);
    int steps = 0;
    while (sim.Turn()) ++steps;
    return steps;
  };
  steps_in(std::chrono::milliseconds(250));
  CHECK(steps_in(std::chrono::milliseconds(500)) == 2);
  config.speed = 4.0;
  sim.service.Reconfigure(config);
  sim.Turn();
  CHECK(steps_in(std::chrono::milliseconds(500)) == 8);
}

}  // namespace
}  // namespace conav::sim
