#include "robot/command_gate.h"

#include <catch2/catch.hpp>

namespace conav::robot {
namespace {

using namespace std::chrono_literals;
using Admission = CommandGate::Admission;

RobotCommand Command(std::uint64_t sequence_number, std::uint64_t lease_epoch = 1,
                     CommandKind kind = CommandKind::kMove) {
  return {.robot = "r1",
          .sequence_number = sequence_number,
          .lease_epoch = lease_epoch,
          .expires_at = SimTime{} + 10s,
          .kind = kind};
}

StopOrder Order(std::uint64_t revision, bool stopped, const std::string& robot = "r1") {
  return {{}, "w1", robot, revision, stopped, "anna", ""};
}

/// What the robot reports of its commands.
RobotState StateOf(const CommandGate& gate) {
  RobotState state;
  gate.Report(state);
  return state;
}

TEST_CASE("A command is carried out once, unless an older one or another robot's",
          "[robot][contract]") {
  CommandGate gate("r1");
  CHECK(gate.Receive(Command(5, 3), {}) == Admission::kStarted);
  CHECK(gate.active());
  CHECK(gate.Receive(Command(5, 3), {}) == Admission::kRepeated);
  for (const RobotCommand& old : {Command(4, 3), Command(9, 2)}) {
    const auto refused = gate.Receive(old, {});
    REQUIRE_FALSE(refused);
    CHECK(refused.error().code == ErrorCode::kRefused);
  }
  // 2^64 - 1 would shut out every planner for good.
  CHECK_FALSE(gate.Receive(Command(1, ~std::uint64_t{0}), {}));
  CHECK_FALSE(gate.Receive(Command(1, 3 + kMaxCounterStep + 1), {}));
  CHECK_FALSE(gate.Receive(Command(5 + kMaxCounterStep + 1, 3), {}));
  RobotCommand of_another = Command(6, 3);
  of_another.robot = "r2";
  CHECK_FALSE(gate.Receive(of_another, {}));
  CHECK(StateOf(gate).command_sequence_number == 5);
  CHECK(gate.Receive(Command(1, 4), {}) == Admission::kStarted);  // a new epoch counts anew
  CHECK(StateOf(gate).lease_epoch == 4);
  CHECK(gate.Receive(Command(1 + kMaxCounterStep, 4), {}) == Admission::kStarted);
}

TEST_CASE("A command is in force until it ends or expires", "[robot][contract]") {
  CommandGate gate("r1");
  REQUIRE(gate.Receive(Command(1), {}));
  CHECK_FALSE(gate.EndIfExpired(SimTime{} + 9999ms));
  CHECK(gate.EndIfExpired(SimTime{} + 10s));
  CHECK(StateOf(gate).command_outcome == CommandOutcome::kExpired);
  CHECK_FALSE(gate.EndIfExpired(SimTime{} + 11s));
  CHECK(gate.Receive(Command(2), SimTime{} + 10s) == Admission::kEnded);  // expired on arrival
  REQUIRE(gate.Receive(Command(3), {}));
  gate.End(CommandOutcome::kBlocked, "a wall");
  CHECK_FALSE(gate.active());
  CHECK(StateOf(gate).command_outcome == CommandOutcome::kBlocked);
  CHECK(StateOf(gate).command_detail == "a wall");
}

TEST_CASE("A stop ends the command in force and is latched, whatever the epoch of a command",
          "[robot][contract]") {
  CommandGate gate("r1");
  REQUIRE(gate.Receive(Command(1), {}));
  CHECK(gate.Receive(Order(1, true)));
  CHECK(StateOf(gate).command_outcome == CommandOutcome::kStopped);
  CHECK(StateOf(gate).stopped);
  CHECK(StateOf(gate).stop_revision == 1);
  CHECK_FALSE(gate.Receive(Order(2, true)));  // nothing to brake any more
  for (const std::uint64_t epoch : {1, 2, 1'000'000}) {
    CHECK(gate.Receive(Command(2, epoch), {}) == Admission::kEnded);
    CHECK(StateOf(gate).command_outcome == CommandOutcome::kStopped);
  }
  CHECK(gate.Receive(Command(3, 1'000'000, CommandKind::kStop), {}) == Admission::kStarted);
}

TEST_CASE("Only a newer order for this robot resumes it, and it waits for a new command then",
          "[robot][contract]") {
  CommandGate gate("r1");
  REQUIRE(gate.Receive(Command(1), {}));
  gate.Receive(Order(5, true));
  for (const StopOrder& order : {Order(5, false), Order(4, false), Order(6, false, "r2")}) {
    gate.Receive(order);
    CHECK(gate.stopped());
  }
  gate.Receive(Order(1, true));  // of an operator that has lost its count: taken, but
  gate.Receive(Order(2, false));
  CHECK(gate.stopped());
  gate.Receive(Order(6, false));
  CHECK_FALSE(gate.stopped());
  CHECK_FALSE(gate.active());
  CHECK(gate.Receive(Command(1), {}) == Admission::kRepeated);  // silence never means go on
  CHECK(gate.Receive(Command(2), {}) == Admission::kStarted);
  gate.Receive(Order(3, true));  // to stand is safe, whatever the revision
  CHECK(gate.stopped());
}

TEST_CASE("From a stop that is far ahead an order leads back that is just newer than the last",
          "[robot][contract]") {
  CommandGate gate("r1");
  gate.Receive(Order(5, true));
  for (const std::uint64_t far : {5 + kMaxCounterStep + 1, ~std::uint64_t{0}}) {
    CAPTURE(far);
    gate.Receive(Order(far, false));  // would leave no newer order to resume the next stop
    CHECK(gate.stopped());
    gate.Receive(Order(far, true));
    CHECK(gate.stopped());
    CHECK(StateOf(gate).stop_revision == 5);
  }
  gate.Receive(Order(6, false));
  CHECK_FALSE(gate.stopped());
  REQUIRE(gate.Receive(Command(1), {}));
  CHECK(gate.Receive(Order(~std::uint64_t{0}, true)));  // ends the command as any stop does
  CHECK(StateOf(gate).command_outcome == CommandOutcome::kStopped);
  gate.Receive(Order(6 + kMaxCounterStep, false));
  CHECK_FALSE(gate.stopped());
}

TEST_CASE("A gate goes on from its last report, a command that was in force has expired",
          "[robot][contract]") {
  CommandGate gate("r1");
  gate.Receive(Order(5, true));
  gate.Receive(Order(6, false));
  REQUIRE(gate.Receive(Command(7), {}));
  CommandGate again("r1");
  again.Restore(StateOf(gate));
  CHECK(StateOf(again).command_outcome == CommandOutcome::kExpired);
  CHECK(StateOf(again).stop_revision == 6);
  CHECK_FALSE(again.Receive(Command(6), {}));
  CHECK(again.Receive(Command(7), {}) == Admission::kRepeated);
  CHECK_FALSE(again.active());
  REQUIRE(again.Receive(Command(8), {}) == Admission::kStarted);
  again.End(CommandOutcome::kBlocked, "a wall");
  CommandGate third("r1");
  third.Restore(StateOf(again));
  CHECK(StateOf(third) == StateOf(again));
}

TEST_CASE("A way is closed where it comes too near to a place that another robot holds",
          "[robot][contract]") {
  CommandGate gate("r1");
  CHECK(gate.IsClear({0, 0}, {4, 0}, 1.0));
  gate.SetHeldByOthers({{4, 0}});
  struct Row {
    Position from, to;
    bool clear;
  };
  const std::vector<Row> rows{{{0, 0}, {4, 0}, false},     {{0, 0}, {8, 0}, false},
                              {{0, 0}, {2.9, 0}, true},    {{0, 0}, {3.1, 0}, false},
                              {{0, 2}, {8, 2}, true},      {{0, 0.9}, {8, 0.9}, false},
                              {{3.5, 0}, {0, 0}, true},  // away from it
                              {{4.2, 0}, {4.2, 0}, false}, {{0, 0}, {0, 0}, true}};
  for (const Row& row : rows) {
    CAPTURE(row.from.x_m, row.from.y_m, row.to.x_m, row.to.y_m);
    CHECK(gate.IsClear(row.from, row.to, 1.0) == row.clear);
  }
}

}  // namespace
}  // namespace conav::robot
