#include "planner/methods/baseline_methods.h"

#include <catch2/catch.hpp>

#include "unit/planner/decision/worker_bench.h"
#include "unit/planner/search/text_map.h"

namespace conav::planner {
namespace {

using namespace std::chrono_literals;

/// A robot at (1,1) of a ring, whose goal lies to the east, with a path of the operator's.
template <class M>
struct MethodBench {
  MethodBench() {
    situation.state.robot = "r1";
    situation.state.cell = {1, 1};
    situation.state.path = {{1, 1}};
    situation.state.goals_left = {{1, 5}};
    situation.map.cells = MapFrom(kRing);
    situation.truth = MapFrom(kRing);
    situation.belief.wall_probability = BeliefFrom(kRing);
    situation.guidance = Guidance{.revision = 1, .path = {{1, 1}, {1, 2}, {1, 3}}};
  }

  void PutRobotAhead() { situation.neighbours = {{"r2", {1, 2}, true, {}}}; }
  Decision Decide() { return method.Decide(situation, StopToken()); }
  /// Where it goes, without asking; nothing when it stands.
  std::optional<Cell> Target() {
    const Decision decision = Decide();
    CHECK_FALSE(decision.attention);
    if (!decision.action) return std::nullopt;
    CHECK(decision.action->kind == CommandKind::kMove);
    return decision.action->target;
  }

  Situation situation;
  FakeClock clock;
  M method{1, clock};
};

TEMPLATE_TEST_CASE("a robot waits for one in its way without asking, then steps out at random",
                   "[planner][baseline]", InstructionMethod, GreedyMethod, MappingMethod) {
  MethodBench<TestType> bench;
  bench.PutRobotAhead();
  CHECK_FALSE(bench.Target());
  bench.clock.Advance(499ms);
  CHECK_FALSE(bench.Target());
  bench.clock.Advance(1ms);
  CHECK(bench.Target() == Cell{2, 1});  // the only free one
  CHECK_FALSE(bench.Target());          // patience starts again
}

using FollowBench = MethodBench<InstructionMethod>;

TEST_CASE("a path is gone leg by leg, also where it comes through a cell twice",
          "[planner][instruction]") {
  FollowBench bench;
  const Decision first = bench.Decide();
  REQUIRE(first.action);
  CHECK(first.action->target == Cell{1, 2});
  CHECK(first.plan == std::vector<Cell>{{1, 2}, {1, 3}});
  CHECK(first.report.chosen == 0);
  bench.situation.guidance->path = {{1, 1}, {1, 2}, {1, 1}, {2, 1}};
  CHECK(bench.Target() == Cell{1, 2});
  bench.situation.state.cell = {1, 2};
  CHECK(bench.Target() == Cell{1, 1});
  bench.situation.state.cell = {1, 1};
  CHECK(bench.Target() == Cell{2, 1});
}

TEST_CASE("the same path given again, and a new path, are followed from their beginning",
          "[planner][instruction]") {
  FollowBench bench;
  bench.situation.state.cell = {1, 2};
  CHECK(bench.Target() == Cell{1, 3});
  // Made room for another robot.
  bench.situation.state.cell = {1, 1};
  CHECK(bench.Decide().attention == AttentionReason::kNoGuidance);
  SECTION("again by the operator") { bench.situation.guidance->revision = 2; }
  SECTION("again by a goal pose") { bench.situation.guidance->stamp = {5}; }
  SECTION("new") { bench.situation.guidance->path = {{1, 1}, {1, 2}, {1, 1}, {2, 1}}; }
  CHECK(bench.Target() == Cell{1, 2});
}

TEST_CASE("a robot asks where it cannot go on, and names what is in the way",
          "[planner][instruction]") {
  FollowBench bench;
  bench.situation.map.cells[{1, 2}] = Occupancy::kOccupied;
  const Decision blocked = bench.Decide();
  CHECK_FALSE(blocked.action);
  CHECK(blocked.attention == AttentionReason::kBlocked);
  CHECK(blocked.attention_cell == Cell{1, 2});
  for (const Cell off : {Cell{1, 3}, Cell{3, 3}}) {  // at the path's end, beside it
    bench.situation.state.cell = off;
    CHECK(bench.Decide().attention == AttentionReason::kNoGuidance);
  }
  bench.situation.guidance.reset();
  CHECK(bench.Decide().attention == AttentionReason::kNoGuidance);
}

TEST_CASE("a wait that ended does not count later", "[planner][instruction]") {
  FollowBench bench;
  bench.PutRobotAhead();
  bench.Decide();
  SECTION("the cell was free meanwhile") {
    bench.situation.neighbours.clear();
    CHECK(bench.Target() == Cell{1, 2});
    bench.PutRobotAhead();
  }
  SECTION("the robot was blocked meanwhile") {
    bench.situation.map.cells[{1, 2}] = Occupancy::kOccupied;
    bench.Decide();
    bench.situation.map.cells[{1, 2}] = Occupancy::kFree;
  }
  SECTION("the path is a new one") { bench.situation.guidance->path = {{1, 1}, {1, 2}}; }
  bench.clock.Advance(1s);
  CHECK_FALSE(bench.Target());
}

TEST_CASE("a robot without goals stays where it is", "[planner][instruction]") {
  FollowBench bench;
  bench.situation.state.goals_left.clear();
  CHECK_FALSE(bench.Target());
}

using GreedyBench = MethodBench<GreedyMethod>;

TEST_CASE("the greedy robot takes the shortest way to its nearest goal", "[planner][greedy]") {
  GreedyBench bench;
  CHECK(bench.Target() == Cell{1, 2});
  CHECK(bench.method.IntendedPathFor(bench.situation).size() == 4);
  bench.situation.state.goals_left = {{1, 5}, {3, 1}};
  CHECK(bench.Target() == Cell{2, 1});
}

TEST_CASE("the greedy robot takes unseen cells for free and pays no heed to the operator",
          "[planner][greedy]") {
  GreedyBench bench;
  bench.situation.guidance->path = {{1, 1}, {2, 1}, {3, 1}};
  CHECK(bench.method.awaits() == AwaitedInput::kNothing);
  bench.situation.map.cells[{1, 2}] = Occupancy::kUnknown;
  CHECK(bench.Target() == Cell{1, 2});
  bench.situation.map.cells[{1, 2}] = Occupancy::kOccupied;
  CHECK(bench.Target() == Cell{2, 1});
}

TEST_CASE("without goals, or a way to one, the greedy robot stays", "[planner][greedy]") {
  GreedyBench bench;
  bench.situation.state.goals_left = {};
  CHECK_FALSE(bench.Target());
  bench.situation.state.goals_left = {{2, 3}};
  CHECK_FALSE(bench.Target());
  bench.situation.state.goals_left = {{1, 5}};
  bench.situation.map.cells[{1, 4}] = bench.situation.map.cells[{3, 4}] = Occupancy::kOccupied;
  CHECK_FALSE(bench.Target());
}

/// A robot that knows nothing itself, and carries out commands at once.
struct MappingBench : MethodBench<MappingMethod> {
  MappingBench() { situation.map.cells = OccupancyGrid(5, 7, Occupancy::kUnknown); }

  /// Drives until it has sent a picture; nothing when it stands before that.
  std::optional<Action> Snapshot() {
    for (int step = 0; step < 100; ++step) {
      const Decision decision = Decide();
      if (!decision.action) return std::nullopt;
      if (decision.action->kind == CommandKind::kTransmitView) {
        ++situation.state.snapshots;
        return decision.action;
      }
      CHECK(AreNeighbours(situation.state.cell, decision.action->target));
      situation.state.cell = decision.action->target;
    }
    return std::nullopt;
  }

  void Answer() { situation.answered_snapshot = situation.state.snapshots; }
};

TEST_CASE("the robot of the mapping task drives the shortest way in the true map to its goal",
          "[planner][mapping]") {
  MappingBench bench;
  const Decision first = bench.Decide();
  REQUIRE(first.action);
  CHECK(first.action->target == Cell{1, 2});
  CHECK(first.plan.size() == 4);
  CHECK_FALSE(first.attention);
  const auto snapshot = bench.Snapshot();
  REQUIRE(snapshot);
  CHECK(snapshot->target == Cell{1, 5});
  --bench.situation.state.snapshots;  // it did not come about: tried again from the same place
  const Decision again = bench.Decide();
  REQUIRE(again.action);
  CHECK(again.action->kind == CommandKind::kTransmitView);
  CHECK(again.action->heading_rad == snapshot->heading_rad);
}

TEST_CASE("after its picture the robot stands until it has the answer and the map of that answer",
          "[planner][mapping]") {
  MappingBench bench;
  REQUIRE(bench.Snapshot());
  CHECK_FALSE(bench.Decide().action);
  bench.situation.belief.revision = 2;  // edits alone do not count
  CHECK_FALSE(bench.Decide().action);
  CHECK(bench.method.IntendedPathFor(bench.situation).empty());
  bench.Answer();
  bench.situation.answered_belief = 3;
  CHECK_FALSE(bench.Decide().action);
  bench.situation.belief.revision = 3;
  CHECK(bench.Decide().action);
}

TEST_CASE("with all goals reached the robot goes on to other places", "[planner][mapping]") {
  MappingBench bench;
  bench.situation.state.goals_left = {};
  for (int i = 0; i < 5; ++i) {
    CHECK(bench.Snapshot());
    bench.Answer();
  }
}

TEST_CASE("the robot of the mapping task waits for the true map and the operator's",
          "[planner][mapping]") {
  MappingBench bench;
  CHECK(bench.method.awaits() == AwaitedInput::kBelief);
  bench.situation.truth.reset();
  CHECK_FALSE(bench.Decide().action);
  CHECK(bench.method.IntendedPathFor(bench.situation).empty());
}

/// A worker with the method.
struct Steered : WorkerBench {
  Steered() : WorkerBench(std::make_unique<TeleopMethod>()) {
    state.stamp = SimTime{} + 10s;
    state.lease_epoch = 3;
    state.goals_left = {{1, 4}};
    PutAll();
  }

  /// Somebody wants an action, until so many seconds of simulation time; then a turn of the worker.
  void Drive(std::uint64_t number, DriveAction drive = DriveAction::kForward, int until_s = 12,
             const std::string& world = "w1") {
    board.Put(DriveOrder{
        {}, world, "r1", number, drive, "somebody", SimTime{} + std::chrono::seconds(until_s)});
    Step();
  }
};

TEST_CASE("an order is passed on once, under the lease and with its own expiry",
          "[planner][teleop]") {
  Steered steered;
  steered.Drive(7, DriveAction::kTurnLeft, 11);
  steered.Step();
  REQUIRE(steered.commands.size() == 1);
  const RobotCommand& command = steered.commands[0];
  CHECK(command.kind == CommandKind::kDrive);
  CHECK(command.drive == DriveAction::kTurnLeft);
  CHECK(command.drive_order == 7);
  CHECK(command.lease_epoch == 4);
  CHECK(command.expires_at == SimTime{} + 11s);
  CHECK(steered.attentions.empty());
}

TEST_CASE("a steered robot stands without an order that is for it, new and in time",
          "[planner][teleop]") {
  Steered steered;
  SECTION("none") {}
  SECTION("too late") { steered.Drive(1, DriveAction::kForward, 10); }
  SECTION("for a robot of another world") { steered.Drive(1, DriveAction::kForward, 12, "w2"); }
  SECTION("carried out for another planner") {
    steered.state.drive_order = 5;
    steered.board.Put(steered.state);
    steered.Drive(5);
  }
  SECTION("another robot wants its cell: it makes no room by itself") {
    steered.PutRobotThatGoesBefore();
  }
  steered.Step();
  steered.clock.Advance(60s);
  steered.Step();
  CHECK(steered.commands.empty());
  CHECK(steered.attentions.empty());
}

TEST_CASE("of orders that pile up while an action runs, the newest is carried out",
          "[planner][teleop]") {
  Steered steered;
  steered.Drive(1);
  REQUIRE(steered.commands.size() == 1);
  steered.Report(CommandOutcome::kRunning);
  for (std::uint64_t number = 2; number <= 6; ++number) steered.Drive(number);
  CHECK(steered.commands.size() == 1);
  steered.Report(CommandOutcome::kDone);
  steered.Step();
  steered.Step();
  REQUIRE(steered.commands.size() == 2);
  CHECK(steered.commands[1].drive_order == 6);
}

TEST_CASE("a low-level action that the robot did not take up is repeated with its old expiry",
          "[planner][teleop]") {
  Steered steered;
  steered.Drive(1);
  steered.state.stamp = SimTime{} + 11s;
  steered.board.Put(steered.state);
  steered.clock.Advance(2s);
  steered.Step();
  REQUIRE(steered.commands.size() == 2);
  CHECK(steered.commands[1].sequence_number == steered.commands[0].sequence_number);
  CHECK(steered.commands[1].expires_at == SimTime{} + 12s);
}

}  // namespace
}  // namespace conav::planner
