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

TEST_CASE("a robot decides when all is there and belongs together, else the reason is named",
          "[planner][gate]") {
  using I = RobotInputs;
  using enum BlockedReason;
  const std::vector<std::pair<BlockedReason, void (*)(I&)>> rows{
      {kNothing, [](I&) {}},
      {kState, [](I& i) { i.state.reset(); }},
      {kMap, [](I& i) { i.map.reset(); }},
      {kMap, [](I& i) { i.state->map_stamp = {100}, i.map->stamp = {99}; }},
      {kNothing, [](I& i) { i.state->map_stamp = {100}, i.map->stamp = {100}; }},
      {kBelief, [](I& i) { i.belief.reset(); }},
      {kBelief, [](I& i) { i.guidance->belief_revision = 2, i.belief->revision = 1; }},
      {kCamera, [](I& i) { i.lens.reset(); }},
      {kFirstGuidance, [](I& i) { i.guidance.reset(); }},
      {kInconsistent, [](I& i) { i.state->cell.row = 7; }},
      {kNoLease, [](I& i) { i.lease.state = Lease::State::kNone; }}};
  for (const auto& [reason, spoil] : rows) {
    RobotInputs inputs = CompleteInputs();
    spoil(inputs);
    CAPTURE(Name(reason));
    CHECK(CheckFresh(inputs) == reason);
  }
}

TEST_CASE(
    "a running command or one not taken up holds the decision, a higher epoch takes the lease",
    "[planner][gate]") {
  RobotInputs inputs = CompleteInputs();
  inputs.state->command_sequence_number = 3;
  inputs.state->lease_epoch = 1;
  inputs.state->command_outcome = CommandOutcome::kRunning;
  CHECK(CheckFresh(inputs, 3, 1) == BlockedReason::kCommand);
  inputs.state->command_outcome = CommandOutcome::kDone;
  CHECK(CheckFresh(inputs, 3, 1) == BlockedReason::kNothing);
  CHECK(CheckFresh(inputs, 4, 1) == BlockedReason::kCommand);
  CHECK(CheckFresh(inputs, 2, 1) == BlockedReason::kNothing);  // somebody used its epoch
  CHECK(CheckFresh(inputs, 3, 2) == BlockedReason::kCommand);  // it shows the last driver's third
  inputs.state->lease_epoch = 5;
  CHECK(CheckFresh(inputs, 0, 4) == BlockedReason::kLeaseLost);
  CHECK(CheckFresh(inputs, 0, 5) == BlockedReason::kNothing);
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
  DecisionGate gate(AwaitedInput::kAnswers, kTimeouts);
  RobotInputs inputs = CompleteInputs();
  inputs.guidance.reset();
  CHECK(gate.Check(inputs, 0, 0, {}) == BlockedReason::kFirstGuidance);
  CHECK(gate.Check(inputs, 0, 0, Clock::TimePoint(10s)) == BlockedReason::kNothing);
}

TEST_CASE("the inputs awaited from the operator grow with the method's need", "[planner][gate]") {
  using enum AwaitedInput;
  RobotInputs inputs = CompleteInputs();
  inputs.belief.reset();
  inputs.guidance.reset();
  inputs.lens.reset();
  const auto held = [&](AwaitedInput awaits) { return CheckFresh(inputs, 0, 0, awaits); };
  CHECK(held(kNothing) == BlockedReason::kNothing);
  inputs.state->cell.row = 9;
  CHECK(held(kNothing) == BlockedReason::kInconsistent);
  inputs.state->cell.row = 1;
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

const std::vector<Cell> kToOutside{{1, 1}, {0, 4}};

TEST_CASE("what does not belong together is named with both values", "[planner][gate]") {
  using I = RobotInputs;
  const std::vector<std::tuple<const char*, const char*, void (*)(I&)>> rows{
      {"operator's map", "5x4", [](I& i) { i.belief->wall_probability = BeliefGrid(5, 4); }},
      {"operator's map", "0.5 m", [](I& i) { i.belief->cell_size_m = 0.5; }},
      {"operator's map", "(-2, -3)",
       [](I& i) {
         i.belief->middle = {1.0, 0.0};
       }},
      {"its state", "4x4",
       [](I& i) {
         i.state->grid = {4, 4, 2.0};
       }},
      {"another", "r9", [](I& i) { i.misaligned = "r9"; }},
      {"true map", "3x5", [](I& i) { i.truth = OccupancyGrid(3, 5); }},
      {"its cell", "(3,1)", [](I& i) { i.state->cell.row = 3; }},
      {"its path", "(0,4)", [](I& i) { i.state->path = kToOutside; }},
      {"goal", "(0,4)", [](I& i) { i.state->goals_left = kToOutside; }},
      {"guidance", "(0,4)", [](I& i) { i.guidance->path = kToOutside; }},
      {"a wall", "(1,1)", [](I& i) { i.map->cells = OccupancyGrid(3, 3, Occupancy::kOccupied); }}};
  for (const auto& [what, value, spoil] : rows) {
    RobotInputs inputs = CompleteInputs();
    REQUIRE_FALSE(Inconsistency(inputs).has_value());
    spoil(inputs);
    CHECK_THAT(Inconsistency(inputs).value_or(""), Catch::Contains(what) && Catch::Contains(value));
  }
}
