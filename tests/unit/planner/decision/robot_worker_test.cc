#include "planner/decision/robot_worker.h"

#include <catch2/catch.hpp>

using namespace conav;
using namespace conav::planner;
using namespace std::chrono_literals;

namespace {

/// Says what it is told to say, and keeps what it saw.
class ScriptedMethod final : public Method {
 public:
  explicit ScriptedMethod(AwaitedInput awaits) : awaits_(awaits) {}

  Decision Decide(const Situation& situation, const StopToken&) override {
    seen.push_back(situation);
    if (while_deciding) while_deciding();
    return next;
  }
  std::vector<Cell> WayFor(const Situation&) override { return {{1, 2}}; }
  AwaitedInput awaits() const override { return awaits_; }

  Decision next;
  std::function<void()> while_deciding;
  std::vector<Situation> seen;

 private:
  AwaitedInput awaits_;
};

RobotWorker::Options WorkerOptions() {
  return {.robot = "r1", .method_name = "scripted", .timeouts = {10s, 10s}, .command_ttl = 5s};
}

struct Bench {
  explicit Bench(AwaitedInput awaits = AwaitedInput::kAnswers,
                 RobotWorker::Options options = WorkerOptions()) {
    auto owned = std::make_unique<ScriptedMethod>(awaits);
    method = owned.get();
    method->next.action = Action{CommandKind::kMove, {1, 2}, 0.0};
    RobotWorker::Outputs outputs{
        .command = [this](const RobotCommand& command) { commands.push_back(command); },
        .report = [this](const SearchReport& report) { reports.push_back(report); },
        .attention = [this](const AttentionRequest& request) { attentions.push_back(request); },
        .way = [](const RobotState&, const MapUpdate&, const std::vector<Cell>&) {}};
    worker.emplace(std::move(options), std::move(owned), board, clock, std::move(outputs));
  }

  void Step() { worker->Step(stop); }

  /// The robot took up the newest command.
  void Report(CommandOutcome outcome) {
    state.lease_epoch = commands.back().lease_epoch;
    state.command_sequence_number = commands.back().sequence_number;
    state.command_outcome = outcome;
    board.Put(state);
  }

  /// The next decision is to ask for guidance.
  void LetItAsk() {
    method->next = Decision{};
    method->next.attention = AttentionReason::kBlocked;
  }

  /// r0, which goes before r1, wants through r1's cell.
  void PutRobotThatGoesBefore() {
    board.Put(RobotState{.world = "w1", .robot = "r0", .cell = {1, 0}, .goals_left = {{4, 4}}});
    board.PutWay("r0", {{1, 1}, {1, 2}});
  }

  void PutAll() {
    board.Put(state);
    board.PutLens("r1", CameraLens{});
    board.PutMap("r1", MapUpdate{{}, 2.0, OccupancyGrid(5, 5, Occupancy::kFree)});
    Belief belief;
    belief.world = "w1";
    belief.wall_probability = BeliefGrid(5, 5);
    board.Put(belief);
    board.Put(guidance);
  }

  RobotState state{.world = "w1", .robot = "r1", .cell = {1, 1}};
  Guidance guidance{.robot = "r1", .revision = 1, .path = {{1, 1}}, .valid_until = {1000}};
  Blackboard board{{{"r0", "w1"}, {"r1", "w1"}}};
  FakeClock clock;
  ScriptedMethod* method = nullptr;
  std::vector<RobotCommand> commands;
  std::vector<SearchReport> reports;
  std::vector<AttentionRequest> attentions;
  std::optional<RobotWorker> worker;
  StopToken stop;
};

}  // namespace

TEST_CASE("nothing is sent before all inputs are there", "[planner][worker]") {
  Bench bench;
  bench.Step();
  CHECK(bench.commands.empty());
  bench.PutAll();
  bench.Step();
  REQUIRE(bench.commands.size() == 1);
  CHECK(bench.commands[0].target == Cell{1, 2});
  CHECK(bench.reports.at(0).decision == 1);
}

TEST_CASE("the next decision waits for the outcome of the last", "[planner][worker]") {
  Bench bench;
  bench.PutAll();
  bench.Step();
  bench.Step();
  CHECK(bench.method->seen.size() == 1);
  bench.Report(CommandOutcome::kDone);
  bench.Step();
  CHECK(bench.method->seen.size() == 2);
}

TEST_CASE("a command that is not taken up is sent again after a second", "[planner][worker]") {
  Bench bench;
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
  Bench bench;
  bench.state.stamp = {1001};
  bench.PutAll();
  bench.Step();
  CHECK_FALSE(bench.method->seen.at(0).guidance.has_value());
  CHECK(bench.method->seen.at(0).guided_before);
}

TEST_CASE("a robot that asked for guidance waits for a newer revision", "[planner][worker]") {
  Bench bench;
  bench.LetItAsk();
  bench.PutAll();
  bench.Step();
  bench.Step();
  CHECK(bench.method->seen.size() == 1);
  REQUIRE(bench.attentions.size() == 1);
  CHECK(bench.attentions[0].reason == AttentionReason::kBlocked);
  bench.guidance.revision = 2;
  bench.board.Put(bench.guidance);
  bench.Step();
  CHECK(bench.method->seen.size() == 2);
}

TEST_CASE("a robot makes room also while it waits for guidance", "[planner][worker]") {
  Bench bench;
  bench.LetItAsk();
  bench.PutAll();
  bench.Step();
  REQUIRE(bench.commands.empty());
  bench.PutRobotThatGoesBefore();
  bench.Step();
  REQUIRE(bench.commands.size() == 1);
  CHECK(bench.commands[0].target.column == 1);
  CHECK(bench.method->seen.size() == 1);
}

TEST_CASE("a robot makes room while the operator looks at its picture", "[planner][worker]") {
  Bench bench;
  bench.state.snapshots = 1;
  bench.PutAll();
  bench.Step();
  REQUIRE(bench.commands.empty());
  CHECK(bench.board.HoldOf("r1") == HoldName(Hold::kAnswer));
  bench.PutRobotThatGoesBefore();
  bench.Step();
  CHECK(bench.commands.size() == 1);
  CHECK(bench.method->seen.empty());
}

TEST_CASE("a robot that waits for guidance claims no way", "[planner][worker]") {
  Bench bench;
  bench.PutAll();
  bench.board.Put(RobotState{.world = "w1", .robot = "r0", .cell = {4, 4}});
  bench.LetItAsk();
  bench.Step();
  CHECK(bench.board.NeighboursOf("r0").at(0).way == std::vector<Cell>{{1, 2}});
  bench.Step();
  CHECK(bench.board.NeighboursOf("r0").at(0).way.empty());
}

TEST_CASE("a robot whose picture is looked at claims no way", "[planner][worker]") {
  Bench bench;
  bench.PutAll();
  bench.board.Put(RobotState{.world = "w1", .robot = "r0", .cell = {4, 4}});
  bench.board.PutWay("r1", {{1, 2}});
  bench.state.snapshots = 1;
  bench.board.Put(bench.state);
  bench.Step();
  CHECK(bench.board.NeighboursOf("r0").at(0).way.empty());
}

TEST_CASE("guidance of an operator who began anew ends the waiting, too", "[planner][worker]") {
  Bench bench;
  bench.LetItAsk();
  bench.guidance.revision = 7;
  bench.PutAll();
  bench.Step();
  bench.guidance.revision = 1;
  bench.board.Put(bench.guidance);
  bench.Step();
  CHECK(bench.method->seen.size() == 2);
}

TEST_CASE("a robot whose inputs do not belong together is not driven", "[planner][worker]") {
  Bench bench;
  bench.PutAll();
  Belief other;
  other.world = "w1";
  other.wall_probability = BeliefGrid(7, 7);
  bench.board.Put(other);
  bench.Step();
  CHECK(bench.method->seen.empty());
  CHECK(bench.board.HoldOf("r1") == HoldName(Hold::kInconsistent));
}

TEST_CASE("a stop during a decision sends nothing", "[planner][worker]") {
  Bench bench;
  bench.PutAll();
  bench.method->while_deciding = [&] { bench.stop.RequestStop(); };
  bench.Step();
  CHECK(bench.method->seen.size() == 1);
  CHECK(bench.commands.empty());
}

TEST_CASE("a goal pose becomes guidance until the operator's next path", "[planner][worker]") {
  Bench bench;
  bench.PutAll();
  bench.board.PutGoalPose("r1", {4.0, 4.0});
  bench.Step();
  const auto guidance = bench.method->seen.at(0).guidance;
  REQUIRE(guidance.has_value());
  CHECK(guidance->given_by == "goal_pose");
  CHECK(guidance->path.front() == Cell{1, 1});
  CHECK(guidance->path.back() == Cell{0, 4});
  CHECK(guidance->path.size() == 5);
}

TEST_CASE("a goal pose for a robot whose method follows no paths is refused", "[planner][worker]") {
  Bench bench(AwaitedInput::kNothing);
  bench.PutAll();
  bench.board.PutGoalPose("r1", {4.0, 4.0});
  bench.Step();
  CHECK(bench.method->seen.at(0).guidance->given_by != "goal_pose");
  CHECK_FALSE(bench.board.Read("r1").goal_pose.has_value());
}

TEST_CASE("nothing is decided for a robot without the lease", "[planner][worker][lease]") {
  Bench bench;
  bench.board.PutLease("r1", {Lease::State::kNone, 0});
  bench.PutAll();
  bench.Step();
  CHECK(bench.method->seen.empty());
  CHECK(bench.commands.empty());
  CHECK(bench.board.HoldOf("r1") == HoldName(Hold::kNoLease));
}

TEST_CASE("commands carry the epoch of the lease", "[planner][worker][lease]") {
  Bench bench;
  bench.state.lease_epoch = 3;
  bench.state.command_sequence_number = 40;
  bench.board.PutLease("r1", {Lease::State::kHeld, 7});
  bench.PutAll();
  bench.Step();
  REQUIRE(bench.commands.size() == 1);
  CHECK(bench.commands[0].lease_epoch == 7);
  CHECK(bench.commands[0].sequence_number == 41);
  CHECK(bench.reports.at(0).decision == 41);
}

TEST_CASE("who takes a robot over waits until the command of the last driver has ended",
          "[planner][worker][lease]") {
  Bench bench;
  bench.state.lease_epoch = 3;
  bench.state.command_sequence_number = 40;
  bench.state.command_outcome = CommandOutcome::kRunning;
  bench.board.PutLease("r1", {Lease::State::kHeld, 4});
  bench.PutAll();
  bench.Step();
  CHECK(bench.commands.empty());
  bench.state.command_outcome = CommandOutcome::kDone;
  bench.board.Put(bench.state);
  bench.Step();
  CHECK(bench.commands.size() == 1);
}

TEST_CASE("a robot that is to be given up ends its command first", "[planner][worker][lease]") {
  Bench bench;
  bench.board.PutLease("r1", {Lease::State::kHeld, 1});
  bench.PutAll();
  bench.Step();
  REQUIRE(bench.commands.size() == 1);
  bench.board.PutLease("r1", {Lease::State::kReleasing, 1});
  bench.Report(CommandOutcome::kRunning);
  bench.Step();
  CHECK(bench.board.LeaseOf("r1").state == Lease::State::kReleasing);
  bench.state.command_outcome = CommandOutcome::kDone;
  bench.board.Put(bench.state);
  bench.Step();
  CHECK(bench.board.LeaseOf("r1").state == Lease::State::kNone);
  CHECK(bench.commands.size() == 1);
}

TEST_CASE("a decision whose lease was lost meanwhile is not sent", "[planner][worker][lease]") {
  Bench bench;
  bench.board.PutLease("r1", {Lease::State::kHeld, 1});
  bench.PutAll();
  bench.method->while_deciding = [&] { bench.board.PutLease("r1", {Lease::State::kNone, 0}); };
  bench.Step();
  CHECK(bench.method->seen.size() == 1);
  CHECK(bench.commands.empty());
}

TEST_CASE("a robot that comes back is driven under the new epoch", "[planner][worker][lease]") {
  Bench bench;
  bench.board.PutLease("r1", {Lease::State::kHeld, 1});
  bench.PutAll();
  bench.Step();
  bench.board.PutLease("r1", {Lease::State::kNone, 0});
  bench.state.lease_epoch = 2;
  bench.state.command_sequence_number = 9;
  bench.state.command_outcome = CommandOutcome::kDone;
  bench.board.Put(bench.state);
  bench.Step();
  REQUIRE(bench.commands.size() == 1);
  bench.board.PutLease("r1", {Lease::State::kHeld, 3});
  bench.Step();
  REQUIRE(bench.commands.size() == 2);
  CHECK(bench.commands[1].lease_epoch == 3);
  CHECK(bench.commands[1].sequence_number == 10);
}

TEST_CASE("requests for attention are numbered on from those of other planners",
          "[planner][worker][lease]") {
  Bench bench;
  bench.LetItAsk();
  bench.board.HeardAttention("r1", 4);
  bench.PutAll();
  bench.Step();
  REQUIRE(bench.attentions.size() == 1);
  CHECK(bench.attentions[0].sequence_number == 5);
}

TEST_CASE("a question tells what waiting costs", "[planner][worker]") {
  Bench bench;
  bench.LetItAsk();
  bench.state.goals_left = {{1, 3}};
  bench.PutAll();
  bench.Step();
  REQUIRE(bench.attentions.size() == 1);
  CHECK(bench.attentions[0].value_lost_per_s > 0.0);
  CHECK(bench.attentions[0].gives_up_at == SimTime{0});  // it waits for ever
}

TEST_CASE("a picture tells until when it waits, and is taken back when it went on alone",
          "[planner][worker]") {
  Bench bench;
  bench.method->next.action = Action{CommandKind::kTransmitView, {}, 0.0};
  bench.method->next.attention = AttentionReason::kPicture;
  bench.state.stamp = SimTime{5'000'000'000};
  bench.guidance.valid_until = SimTime{1'000'000'000'000};
  bench.PutAll();
  bench.Step();
  REQUIRE(bench.attentions.size() == 1);
  CHECK(bench.attentions[0].gives_up_at == SimTime{15'000'000'000});
  bench.state.snapshots = 1;
  bench.Report(CommandOutcome::kDone);
  bench.Step();
  bench.method->next = Decision{};
  bench.clock.Advance(10s);
  bench.Step();
  REQUIRE(bench.attentions.size() == 2);
  CHECK(bench.attentions[1].reason == AttentionReason::kNone);
  CHECK(bench.attentions[1].sequence_number > bench.attentions[0].sequence_number);
}

TEST_CASE("with timeouts in simulation time the wall clock ends no waiting", "[planner][worker]") {
  RobotWorker::Options options = WorkerOptions();
  options.timeouts_in_simulation_time = true;
  Bench bench(AwaitedInput::kAnswers, options);
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
