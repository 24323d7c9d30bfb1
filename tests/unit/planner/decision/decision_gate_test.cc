#include <catch2/catch.hpp>

#include "planner/decision/robot_worker.h"

using namespace conav;
using namespace conav::planner;
using namespace std::chrono_literals;

namespace {

RobotInputs CompleteInputs() {
  RobotInputs inputs;
  inputs.state = RobotState{.cell = {1, 1}};
  inputs.map = MapUpdate{{}, 2.0, OccupancyGrid(3, 3, Occupancy::kFree)};
  inputs.belief = Belief{};
  inputs.belief->wall_probability = BeliefGrid(3, 3);
  inputs.lens = CameraLens{};
  inputs.guidance = Guidance{};
  return inputs;
}

constexpr DecisionGate::Timeouts kTimeouts{.first_guidance = 10s, .answer = 10s};

BlockedReason CheckFresh(const RobotInputs& inputs, std::uint64_t sent = 0, std::uint64_t epoch = 0,
                         AwaitedInput awaits = AwaitedInput::kAnswers) {
  return DecisionGate(awaits, kTimeouts).Check(inputs, sent, epoch, {});
}

}  // namespace

TEST_CASE("a robot decides when state, map, belief and guidance are there", "[planner][gate]") {
  CHECK(CheckFresh(CompleteInputs()) == BlockedReason::kNothing);
}

TEST_CASE("each missing input holds the decision and is named", "[planner][gate]") {
  RobotInputs inputs = CompleteInputs();
  inputs.state.reset();
  CHECK(CheckFresh(inputs) == BlockedReason::kState);
  inputs = CompleteInputs();
  inputs.map.reset();
  CHECK(CheckFresh(inputs) == BlockedReason::kMap);
  inputs = CompleteInputs();
  inputs.belief.reset();
  CHECK(CheckFresh(inputs) == BlockedReason::kBelief);
  inputs = CompleteInputs();
  inputs.lens.reset();
  CHECK(CheckFresh(inputs) == BlockedReason::kCamera);
  inputs = CompleteInputs();
  inputs.guidance.reset();
  CHECK(CheckFresh(inputs) == BlockedReason::kFirstGuidance);
}

TEST_CASE("a step aside does not start the waiting for an answer anew", "[planner][gate]") {
  DecisionGate gate(AwaitedInput::kAnswers, kTimeouts);
  RobotInputs inputs = CompleteInputs();
  inputs.state->snapshots = 1;
  Clock::TimePoint now{};
  CHECK(gate.Check(inputs, 0, 0, now) == BlockedReason::kAnswer);
  inputs.state->command_outcome = CommandOutcome::kRunning;
  CHECK(gate.Check(inputs, 0, 0, now + 6s) == BlockedReason::kCommand);
  inputs.state->command_outcome = CommandOutcome::kDone;
  CHECK(gate.Check(inputs, 0, 0, now + 9s) == BlockedReason::kAnswer);
  CHECK(gate.Check(inputs, 0, 0, now + 10s) == BlockedReason::kNothing);
}

TEST_CASE("inputs of different worlds hold the decision", "[planner][gate]") {
  RobotInputs inputs = CompleteInputs();
  inputs.state->cell = {7, 7};
  CHECK(CheckFresh(inputs) == BlockedReason::kInconsistent);
}

TEST_CASE("a map older than the robot's newest step holds the decision", "[planner][gate]") {
  RobotInputs inputs = CompleteInputs();
  inputs.state->map_stamp = {100};
  inputs.map->stamp = {99};
  CHECK(CheckFresh(inputs) == BlockedReason::kMap);
  inputs.map->stamp = {100};
  CHECK(CheckFresh(inputs) == BlockedReason::kNothing);
}

TEST_CASE("a running command or one not taken up holds the decision", "[planner][gate]") {
  RobotInputs inputs = CompleteInputs();
  inputs.state->command_sequence_number = 3;
  inputs.state->lease_epoch = 1;
  inputs.state->command_outcome = CommandOutcome::kRunning;
  CHECK(CheckFresh(inputs, 3, 1) == BlockedReason::kCommand);
  inputs.state->command_outcome = CommandOutcome::kDone;
  CHECK(CheckFresh(inputs, 3, 1) == BlockedReason::kNothing);
  CHECK(CheckFresh(inputs, 4, 1) == BlockedReason::kCommand);
  CHECK(CheckFresh(inputs, 3, 2) == BlockedReason::kCommand);  // it shows the last driver's third
}

TEST_CASE("a higher lease epoch on the robot means that it is no longer ours", "[planner][gate]") {
  RobotInputs inputs = CompleteInputs();
  inputs.state->lease_epoch = 5;
  CHECK(CheckFresh(inputs, 0, 4) == BlockedReason::kLeaseLost);
  CHECK(CheckFresh(inputs, 0, 5) == BlockedReason::kNothing);
}

TEST_CASE("without a lease a robot is held, whatever is there", "[planner][gate]") {
  RobotInputs inputs = CompleteInputs();
  inputs.lease.state = Lease::State::kNone;
  CHECK(CheckFresh(inputs) == BlockedReason::kNoLease);
}

TEST_CASE("guidance drawn on a newer belief waits for that belief", "[planner][gate]") {
  RobotInputs inputs = CompleteInputs();
  inputs.guidance->belief_revision = 2;
  inputs.belief->revision = 1;
  CHECK(CheckFresh(inputs) == BlockedReason::kBelief);
}

TEST_CASE("an unanswered picture is waited for once, until the timeout", "[planner][gate]") {
  FakeClock clock;
  DecisionGate gate(AwaitedInput::kAnswers, kTimeouts);
  RobotInputs inputs = CompleteInputs();
  inputs.state->snapshots = 1;
  CHECK(gate.Check(inputs, 0, 0, clock.Now()) == BlockedReason::kAnswer);
  clock.Advance(9s);
  CHECK(gate.Check(inputs, 0, 0, clock.Now()) == BlockedReason::kAnswer);
  clock.Advance(1s);
  CHECK(gate.Check(inputs, 0, 0, clock.Now()) == BlockedReason::kNothing);
  CHECK(gate.TakeTimedOut());
  CHECK_FALSE(gate.TakeTimedOut());
  inputs.state->snapshots = 2;
  CHECK(gate.Check(inputs, 0, 0, clock.Now()) == BlockedReason::kAnswer);
  inputs.guidance->answers_snapshot = 2;
  CHECK(gate.Check(inputs, 0, 0, clock.Now()) == BlockedReason::kNothing);
}

TEST_CASE("without an operator the robot goes on alone after the timeout", "[planner][gate]") {
  FakeClock clock;
  DecisionGate gate(AwaitedInput::kAnswers, kTimeouts);
  RobotInputs inputs = CompleteInputs();
  inputs.guidance.reset();
  CHECK(gate.Check(inputs, 0, 0, clock.Now()) == BlockedReason::kFirstGuidance);
  clock.Advance(10s);
  CHECK(gate.Check(inputs, 0, 0, clock.Now()) == BlockedReason::kNothing);
}

TEST_CASE("what is waited for from the operator grows with the method's need", "[planner][gate]") {
  using enum AwaitedInput;
  RobotInputs inputs = CompleteInputs();
  inputs.belief.reset();
  inputs.guidance.reset();
  inputs.lens.reset();
  const auto held = [&](AwaitedInput awaits) { return CheckFresh(inputs, 0, 0, awaits); };
  CHECK(held(kNothing) == BlockedReason::kNothing);
  CHECK(held(kBelief) == BlockedReason::kBelief);
  inputs.belief = CompleteInputs().belief;
  CHECK(held(kBelief) == BlockedReason::kNothing);
  CHECK(held(kGuidance) == BlockedReason::kFirstGuidance);
  inputs.guidance = Guidance{};
  inputs.state->snapshots = 7;
  CHECK(held(kGuidance) == BlockedReason::kNothing);
  CHECK(held(kAnswers) == BlockedReason::kCamera);
  inputs.lens = CameraLens{};
  CHECK(held(kAnswers) == BlockedReason::kAnswer);
}

TEST_CASE("a robot that waits for no operator is held by inputs of different worlds, too",
          "[planner][gate]") {
  RobotInputs inputs = CompleteInputs();
  inputs.belief.reset();
  inputs.state->cell = {9, 9};
  CHECK(CheckFresh(inputs, 0, 0, AwaitedInput::kNothing) == BlockedReason::kInconsistent);
}

TEST_CASE("a stopped robot is held, but may still be given up once it stands", "[planner][gate]") {
  RobotInputs inputs = CompleteInputs();
  inputs.stop_order = StopOrder{.stopped = true};
  CHECK(CheckFresh(inputs) == BlockedReason::kStopped);
  inputs.lease.state = Lease::State::kReleasing;
  CHECK(CheckFresh(inputs) == BlockedReason::kRelease);
  inputs.state->command_outcome = CommandOutcome::kRunning;
  CHECK(CheckFresh(inputs) == BlockedReason::kStopped);
  inputs.lease.state = Lease::State::kNone;
  CHECK(CheckFresh(inputs) == BlockedReason::kNoLease);
}
