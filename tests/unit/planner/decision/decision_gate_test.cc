#include <catch2/catch.hpp>
#include <functional>

#include "planner/decision/robot_worker.h"
#include "unit/planner/decision/worker_bench.h"

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

// After the gate: a robot that decided to wait.

// The faults report: with 32 robots 28 decisions for each move, as robots that wait decided at every
// message.
TEST_CASE("a robot that decided to wait does not decide again before anything changes",
          "[planner][worker]") {
  WorkerBench bench;
  bench.method->next = Decision{};
  bench.state.goals_left = {{1, 3}};
  RobotState other{.world = "w1", .robot = "r0", .cell = {4, 4}, .goals_left = {{4, 3}}};
  bench.board.Put(other);
  bench.PutAllAndStep();
  REQUIRE(bench.method->seen.size() == 1);
  for (int i = 1; i <= 40; ++i) {
    bench.clock.Advance(100ms);
    bench.state.stamp = {i};
    bench.PutStateAndStep();
    other.cell = {4, 3 + i % 2};  // far from it and its way
    bench.board.Put(other);
    bench.Step();
  }
  CHECK(bench.method->seen.size() == 1);
  CHECK(bench.Step() == bench.clock.Now() + 1s);
  bench.clock.Advance(1s);  // 5 s after the decision
  bench.Step();
  CHECK(bench.method->seen.size() == 2);
}

TEST_CASE("a robot that waits decides again when something changes on which that depends",
          "[planner][worker]") {
  struct Cause {
    const char* name;
    std::function<void(WorkerBench&)> happen;
  };
  RobotState other{.world = "w1", .robot = "r0", .cell = {4, 4}, .goals_left = {{4, 3}}};
  const auto cause = GENERATE_COPY(values<Cause>(
      {{"its map",
        [](WorkerBench& bench) {
          bench.board.PutMap("r1", {{}, 2.0, OccupancyGrid(5, 5, Occupancy::kUnknown)});
        }},
       {"the operator's map",
        [](WorkerBench& bench) {
          bench.board.Put(
              Belief{.world = "w1", .revision = 1, .wall_probability = BeliefGrid(5, 5)});
        }},
       {"guidance",
        [](WorkerBench& bench) {
          ++bench.guidance.revision;
          bench.board.Put(bench.guidance);
        }},
       {"a goal pose",
        [](WorkerBench& bench) {
          bench.board.PutRoute("r1", {{4.0, 4.0}});
        }},
       {"an order of who steers it",
        [](WorkerBench& bench) { bench.board.Put(DriveOrder{.world = "w1", .robot = "r1"}); }},
       {"its goals",
        [](WorkerBench& bench) {
          bench.state.goals_left = {{3, 3}};
          bench.board.Put(bench.state);
        }},
       {"a robot comes next to its way",
        [=](WorkerBench& bench) mutable {
          other.cell = {1, 3};
          bench.board.Put(other);
        }},
       {"a robot drives into its way",
        [=](WorkerBench& bench) mutable {
          other.cell = {3, 2};
          other.command_cell = {2, 2};
          other.command_outcome = CommandOutcome::kRunning;
          bench.board.Put(other);
        }},
       {"a lease",
        [](WorkerBench& bench) {
          bench.board.PutLease("r1", {Lease::State::kHeld, 7});
        }},
       {"the time that the method named",
        [](WorkerBench& bench) { bench.clock.Advance(400ms); }}}));
  CAPTURE(cause.name);
  WorkerBench bench;
  bench.method->next = Decision{};
  bench.method->next.again = bench.clock.Now() + 400ms;
  bench.state.goals_left = {{1, 3}};
  bench.state.goals_stamp = {1};
  bench.board.Put(other);
  bench.PutAllAndStep();
  bench.Step();
  REQUIRE(bench.method->seen.size() == 1);
  cause.happen(bench);
  bench.Step();
  CHECK(bench.method->seen.size() == 2);
}

TEST_CASE("a planner that finds a robot waiting for an answer asks in its place",
          "[planner][worker]") {
  WorkerBench bench;
  bench.state.snapshots = 3;
  bench.state.path = {bench.state.cell};
  bench.PutAllAndStep();
  REQUIRE(bench.attentions.size() == 1);
  CHECK(bench.attentions[0].reason == AttentionReason::kSnapshot);
  CHECK(bench.attentions[0].newest_snapshot == 2);
  CHECK(bench.attentions[0].gives_up_after_s == 10.0);
  bench.Step();
  CHECK(bench.attentions.size() == 1);
  bench.guidance.answers_snapshot = 3;
  bench.PutAllAndStep();
  CHECK(bench.commands.size() == 1);
}
