#include "unit/planner/decision/worker_bench.h"

using namespace conav;
using namespace conav::planner;
using namespace std::chrono_literals;

TEST_CASE("nothing is sent before all inputs are there", "[planner][worker]") {
  WorkerBench bench;
  bench.Step();
  CHECK(bench.commands.empty());
  bench.PutAll();
  bench.Step();
  REQUIRE(bench.commands.size() == 1);
  CHECK(bench.commands[0].target == Cell{1, 2});
  CHECK(bench.reports.at(0).decision == 1);
}

TEST_CASE("the next decision waits for the outcome of the last", "[planner][worker]") {
  WorkerBench bench;
  bench.PutAll();
  bench.Step();
  bench.Step();
  CHECK(bench.method->seen.size() == 1);
  bench.Report(CommandOutcome::kDone);
  bench.Step();
  CHECK(bench.method->seen.size() == 2);
}

TEST_CASE("a robot that met another one waits for a change or a moment before it decides again",
          "[planner][worker]") {
  WorkerBench bench;
  bench.PutAll();
  bench.Step();
  bench.Report(CommandOutcome::kOccupied);
  const auto again = bench.Step();
  CHECK(bench.method->seen.size() == 1);
  CHECK(again > bench.clock.Now());
  CHECK(again <= bench.clock.Now() + 1s);
  bench.Step();
  CHECK(bench.method->seen.size() == 2);
}

TEST_CASE("a command that is not taken up is sent again after a second", "[planner][worker]") {
  WorkerBench bench;
  bench.PutAll();
  bench.Step();
  bench.clock.Advance(999ms);
  bench.Step();
  CHECK(bench.commands.size() == 1);
  bench.clock.Advance(1ms);
  bench.Step();
  REQUIRE(bench.commands.size() == 2);
  CHECK(bench.commands[1].sequence_number == bench.commands[0].sequence_number);
}

TEST_CASE("expired and withdrawn guidance is not shown to the method", "[planner][worker]") {
  WorkerBench bench;
  bench.state.stamp = {1001};
  bench.PutAll();
  bench.Step();
  CHECK_FALSE(bench.method->seen.at(0).guidance.has_value());
  CHECK(bench.method->seen.at(0).guided_before);
}

TEST_CASE(
    "a robot that asked for guidance waits for another revision, also of an operator who "
    "starts again",
    "[planner][worker]") {
  WorkerBench bench;
  bench.LetItAsk();
  bench.guidance.revision = 7;
  bench.state.goals_left = {{1, 3}};
  bench.PutAll();
  bench.Step();
  bench.Step();
  CHECK(bench.method->seen.size() == 1);
  REQUIRE(bench.attentions.size() == 1);
  CHECK(bench.attentions[0].reason == AttentionReason::kBlocked);
  CHECK(bench.attentions[0].value_lost_per_s > 0.0);
  CHECK(bench.attentions[0].gives_up_at == SimTime{0});  // it waits for ever
  CHECK(bench.attentions[0].gives_up_after_s == 0.0);
  bench.guidance.revision = GENERATE(8, 1);
  bench.board.Put(bench.guidance);
  bench.Step();
  CHECK(bench.method->seen.size() == 2);
}

TEST_CASE("a robot makes room also while it waits for guidance or an answer", "[planner][worker]") {
  WorkerBench bench;
  bench.LetItAsk();
  SECTION("guidance") {}
  SECTION("an answer") { bench.state.snapshots = 1; }
  bench.PutAll();
  bench.Step();
  REQUIRE(bench.commands.empty());
  const std::size_t decisions = bench.method->seen.size();
  bench.PutRobotThatGoesBefore();
  bench.Step();
  REQUIRE(bench.commands.size() == 1);
  CHECK(bench.commands[0].target.column == 1);
  CHECK(bench.method->seen.size() == decisions);
}

TEST_CASE("a robot intends no path while it waits for guidance, or for an answer to its picture",
          "[planner][worker]") {
  WorkerBench bench;
  bench.PutAll();
  bench.board.Put(RobotState{.world = "w1", .robot = "r0", .cell = {4, 4}});
  bench.LetItAsk();
  bench.Step();
  CHECK(bench.board.NeighboursOf("r0").at(0).path == std::vector<Cell>{{1, 2}});
  SECTION("guidance") {}
  SECTION("an answer") {
    bench.state.snapshots = 1;
    bench.board.Put(bench.state);
  }
  bench.Step();
  CHECK(bench.board.NeighboursOf("r0").at(0).path.empty());
}

TEST_CASE("a stop during a decision sends nothing", "[planner][worker]") {
  WorkerBench bench;
  bench.PutAll();
  bench.method->while_deciding = [&] { bench.stop.RequestStop(); };
  bench.Step();
  CHECK(bench.method->seen.size() == 1);
  CHECK(bench.commands.empty());
}

TEST_CASE("a goal pose becomes guidance, unless the method follows no paths", "[planner][worker]") {
  const bool follows = GENERATE(true, false);
  WorkerBench bench(follows ? AwaitedInput::kAnswers : AwaitedInput::kNothing);
  bench.PutAll();
  bench.board.PutGoalPose("r1", {4.0, 4.0});
  bench.Step();
  const Guidance guidance = bench.method->seen.at(0).guidance.value();
  CHECK((guidance.given_by == "goal_pose") == follows);
  CHECK_FALSE(bench.board.Read("r1").goal_pose.has_value());
  if (!follows) return;
  CHECK(guidance.path.front() == Cell{1, 1});
  CHECK(guidance.path.back() == Cell{0, 4});
  CHECK(guidance.path.size() == 5);
}

TEST_CASE("a picture's request names its end by the clock that counts, and is withdrawn then",
          "[planner][worker]") {
  const bool in_simulation_time = GENERATE(false, true);
  RobotWorker::Options options = WorkerOptions();
  options.timeouts_in_simulation_time = in_simulation_time;
  WorkerBench bench(AwaitedInput::kAnswers, options);
  bench.method->next.action = Action{CommandKind::kTransmitView, {}, 0.0};
  bench.method->next.attention = AttentionReason::kPicture;
  bench.state.stamp = SimTime{5'000'000'000};
  bench.guidance.valid_until = SimTime{1'000'000'000'000};
  bench.PutAll();
  bench.Step();
  REQUIRE(bench.attentions.size() == 1);
  const AttentionRequest asked = bench.attentions[0];
  CHECK(asked.gives_up_at == SimTime{in_simulation_time ? 15'000'000'000 : 0});
  CHECK(asked.gives_up_after_s == (in_simulation_time ? 0.0 : 10.0));
  bench.state.snapshots = 1;
  bench.Report(CommandOutcome::kDone);
  bench.Step();
  bench.method->next = Decision{};
  bench.clock.Advance(10s);
  bench.state.stamp = SimTime{15'000'000'000};
  bench.board.Put(bench.state);
  bench.Step();
  REQUIRE(bench.attentions.size() == 2);
  CHECK(bench.attentions[1].reason == AttentionReason::kNone);
  CHECK(bench.attentions[1].sequence_number > asked.sequence_number);
}

TEST_CASE("with timeouts in simulation time the wall clock ends no waiting", "[planner][worker]") {
  RobotWorker::Options options = WorkerOptions();
  options.timeouts_in_simulation_time = true;
  WorkerBench bench(AwaitedInput::kAnswers, options);
  bench.state.snapshots = 1;
  bench.PutAll();
  bench.Step();
  bench.clock.Advance(100s);
  bench.Step();
  CHECK(bench.method->seen.empty());
  bench.state.stamp = SimTime{10'000'000'000};
  bench.board.Put(bench.state);
  bench.Step();
  CHECK(bench.method->seen.size() == 1);
}

namespace {

StopOrder Order(std::uint64_t revision, bool stopped) {
  return {{1000}, "w1", "r1", revision, stopped, "anna", "look"};
}

}  // namespace

TEST_CASE("a robot that is stopped ends its command at once and stands until it is resumed",
          "[planner][worker]") {
  WorkerBench bench;
  bench.PutAll();
  bench.Step();
  REQUIRE(bench.commands.size() == 1);
  bench.Report(CommandOutcome::kRunning);
  bench.board.Put(Order(1, true));
  bench.Step();
  REQUIRE(bench.commands.size() == 2);
  CHECK(bench.commands[1].kind == CommandKind::kStop);
  bench.Step();
  CHECK(bench.commands.size() == 2);
  bench.clock.Advance(1s);
  bench.Step();
  REQUIRE(bench.commands.size() == 3);  // not taken up: sent again
  CHECK(bench.commands[2].sequence_number == bench.commands[1].sequence_number);
  bench.Report(CommandOutcome::kDone);
  bench.Step();
  CHECK(bench.commands.size() == 3);
  CHECK(bench.board.BlockedReasonOf("r1") == Name(BlockedReason::kStopped));
  bench.board.Put(Order(2, false));
  bench.Step();
  REQUIRE(bench.commands.size() == 4);
  CHECK(bench.commands[3].kind == CommandKind::kMove);
}

TEST_CASE("a robot that is stopped before it moves gets no command at all", "[planner][worker]") {
  WorkerBench bench;
  bench.board.Put(Order(1, true));
  bench.PutAll();
  bench.Step();
  CHECK(bench.commands.empty());
}
