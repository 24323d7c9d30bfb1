// What a worker does when robots are shared with other planner processes.
#include "unit/planner/decision/worker_bench.h"

using namespace conav;
using namespace conav::planner;

namespace {

constexpr Lease kNoLease{Lease::State::kNone, 0};

/// r1 under `lease`, as the last driver left it: epoch 3, command 40.
struct SharedBench : WorkerBench {
  explicit SharedBench(Lease lease) {
    state.lease_epoch = 3;
    state.command_sequence_number = 40;
    board.PutLease("r1", lease);
  }
  /// The robot as it is now, and a turn of the worker.
  void PutAndStep(CommandOutcome outcome) {
    state.command_outcome = outcome;
    board.Put(state);
    Step();
  }
};

}  // namespace

TEST_CASE("nothing is decided for a robot without the lease", "[planner][worker][lease]") {
  WorkerBench bench;
  bench.board.PutLease("r1", kNoLease);
  bench.PutAll();
  bench.Step();
  CHECK(bench.method->seen.empty());
  CHECK(bench.commands.empty());
  CHECK(bench.board.BlockedReasonOf("r1") == Name(BlockedReason::kNoLease));
}

TEST_CASE("commands carry the lease's epoch, once the command of the last driver has ended",
          "[planner][worker][lease]") {
  SharedBench bench({Lease::State::kHeld, 7});
  bench.state.command_outcome = CommandOutcome::kRunning;
  bench.PutAll();
  bench.Step();
  CHECK(bench.commands.empty());
  bench.PutAndStep(CommandOutcome::kDone);
  REQUIRE(bench.commands.size() == 1);
  CHECK(bench.commands[0].lease_epoch == 7);
  CHECK(bench.commands[0].sequence_number == 41);
  CHECK(bench.reports.at(0).decision == 41);
}

TEST_CASE("a robot that is to be given up ends its command first", "[planner][worker][lease]") {
  WorkerBench bench;
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
  WorkerBench bench;
  bench.board.PutLease("r1", {Lease::State::kHeld, 1});
  bench.PutAll();
  bench.method->while_deciding = [&] { bench.board.PutLease("r1", kNoLease); };
  bench.Step();
  CHECK(bench.method->seen.size() == 1);
  CHECK(bench.commands.empty());
}

TEST_CASE("a robot that comes back is driven under the new epoch", "[planner][worker][lease]") {
  WorkerBench bench;
  bench.board.PutLease("r1", {Lease::State::kHeld, 1});
  bench.PutAll();
  bench.Step();
  bench.board.PutLease("r1", kNoLease);
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

TEST_CASE("who takes a robot over publishes its intended path, also where it is the last driver's",
          "[planner][worker][lease]") {
  WorkerBench bench;
  bench.board.PutLease("r1", {Lease::State::kHeld, 1});
  bench.PutAll();
  bench.board.PutIntendedPath("r1", {{1, 2}});
  bench.Step();
  CHECK(bench.intended_paths == std::vector<IntendedPath>{{"r1", {{1, 2}}, {}}});
  bench.Report(CommandOutcome::kDone);
  bench.Step();
  CHECK(bench.intended_paths.size() == 1);
}

TEST_CASE("no path is published for a robot that another planner drives",
          "[planner][worker][lease]") {
  SharedBench bench(GENERATE(as<Lease>{}, kNoLease, Lease{Lease::State::kHeld, 1}));
  bench.PutAll();
  bench.board.PutIntendedPath("r1", {{4, 4}});
  bench.Step();
  CHECK(bench.intended_paths.empty());
  CHECK(bench.commands.empty());
}

TEST_CASE("requests for attention are numbered on from those of other planners",
          "[planner][worker][lease]") {
  WorkerBench bench;
  bench.LetItAsk();
  bench.board.ReceivedAttention("r1", 4);
  bench.PutAll();
  bench.Step();
  REQUIRE(bench.attentions.size() == 1);
  CHECK(bench.attentions[0].sequence_number == 5);
}
