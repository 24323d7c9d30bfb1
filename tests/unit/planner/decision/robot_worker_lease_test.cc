// What a worker does when robots are shared with other planner processes.
#include "unit/planner/decision/worker_bench.h"

using namespace conav;
using namespace conav::planner;

TEST_CASE("nothing is decided for a robot without the lease", "[planner][worker][lease]") {
  WorkerBench bench;
  bench.board.PutLease("r1", {Lease::State::kNone, 0});
  bench.PutAll();
  bench.Step();
  CHECK(bench.method->seen.empty());
  CHECK(bench.commands.empty());
  CHECK(bench.board.BlockedReasonOf("r1") == Name(BlockedReason::kNoLease));
}

TEST_CASE("commands carry the epoch of the lease", "[planner][worker][lease]") {
  WorkerBench bench;
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
  WorkerBench bench;
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
  bench.method->while_deciding = [&] { bench.board.PutLease("r1", {Lease::State::kNone, 0}); };
  bench.Step();
  CHECK(bench.method->seen.size() == 1);
  CHECK(bench.commands.empty());
}

TEST_CASE("a robot that comes back is driven under the new epoch", "[planner][worker][lease]") {
  WorkerBench bench;
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

TEST_CASE("who takes a robot over tells its way, also where the last driver told the same",
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

TEST_CASE("nothing is wanted for a robot that another planner drives", "[planner][worker][lease]") {
  WorkerBench bench;
  bench.PutAll();
  bench.board.PutIntendedPath("r1", {{4, 4}});
  bench.state.lease_epoch = 2;
  bench.board.Put(bench.state);
  const Lease lease = GENERATE(Lease{Lease::State::kNone, 0}, Lease{Lease::State::kHeld, 1});
  bench.board.PutLease("r1", lease);
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
