#include <catch2/catch.hpp>

#include "planner/decision/robot_worker.h"

using namespace conav;
using namespace conav::planner;
using namespace std::chrono_literals;

TEST_CASE("the first command takes the lease one epoch above the robot's", "[planner][command]") {
  CommandPublisher desk("r1", 5s);
  RobotState state;
  state.lease_epoch = 6;
  state.command_sequence_number = 41;
  const RobotCommand command = desk.Issue({CommandKind::kMove, {2, 3}, 0.0}, state, {1000});
  CHECK(command.lease_epoch == 7);
  CHECK(command.sequence_number == 42);
  CHECK(command.expires_at == SimTime{1000} + 5s);
  CHECK(command.target == Cell{2, 3});
  CHECK(command.robot == "r1");
}

TEST_CASE("sequence numbers rise and the epoch stays", "[planner][command]") {
  CommandPublisher desk("r1", 5s);
  const RobotState state;
  const auto first = desk.Issue({}, state, {});
  const auto second = desk.Issue({CommandKind::kTransmitView, {}, 1.5}, state, {});
  CHECK(second.sequence_number == first.sequence_number + 1);
  CHECK(second.lease_epoch == first.lease_epoch);
  CHECK(second.heading_rad == 1.5);
}

TEST_CASE("only a command that was not taken up is repeated, with a fresh expiry",
          "[planner][command]") {
  CommandPublisher desk("r1", 5s);
  RobotState state;
  CHECK_FALSE(desk.Repeat(state, {}).has_value());
  const auto command = desk.Issue({}, state, {});
  const auto repeat = desk.Repeat(state, SimTime{} + 7s);
  REQUIRE(repeat.has_value());
  CHECK(repeat->sequence_number == command.sequence_number);
  CHECK(repeat->expires_at == SimTime{} + 12s);
  state.command_sequence_number = command.sequence_number;
  CHECK(desk.Repeat(state, {}).has_value());  // another planner's
  state.lease_epoch = command.lease_epoch;
  CHECK_FALSE(desk.Repeat(state, {}).has_value());
}
