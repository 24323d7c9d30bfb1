#include "planner/methods/baseline_methods.h"
#include "unit/planner/decision/worker_bench.h"

using namespace conav;
using namespace conav::planner;
using namespace std::chrono_literals;

namespace {

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

}  // namespace

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

TEST_CASE("a robot that another planner took over is not driven", "[planner][teleop]") {
  Steered steered;
  steered.Drive(1);
  steered.Report(CommandOutcome::kDone);
  steered.state.lease_epoch = 9;
  steered.board.Put(steered.state);
  steered.Drive(2);
  CHECK(steered.commands.size() == 1);
}
