#include "launcher/soak_checks.h"

#include <unistd.h>

#include <catch2/catch.hpp>

#include "operator/belief/belief_store.h"
#include "support/drawn_map.h"
#include "support/temporary_folder.h"

namespace conav::launcher {
namespace {

using namespace std::chrono_literals;

/// A stopped robot that stands at (1, 1).
RobotState Standing() {
  RobotState state;
  state.robot = "r1";
  state.stopped = true;
  state.stop_revision = 3;
  state.position = {1.0, 1.0};
  return state;
}

/// How many violations `states` are, seen one after the other.
std::uint64_t Violations(std::vector<RobotState> states, bool held = false) {
  Invariants invariants;
  if (held) invariants.Hold("r1");
  for (const RobotState& state : states) invariants.See(state);
  return invariants.count();
}

TEST_CASE("a robot that was stopped neither moves nor goes on by itself", "[launcher][soak]") {
  RobotState moved = Standing();
  moved.position.x_m += 0.1;
  RobotState entered = Standing();
  ++entered.cell_moves;
  RobotState resumed = moved;
  resumed.stopped = false;
  RobotState stopped_again = moved;
  stopped_again.stop_revision += 2;
  RobotState rolls = Standing();
  rolls.speed_mps = 0.5;
  CHECK(Violations({Standing(), Standing()}, true) == 0);
  CHECK(Violations({Standing(), moved}) == 1);
  CHECK(Violations({Standing(), entered}) == 1);
  CHECK(Violations({rolls, moved}) == 0);
  CHECK(Violations({Standing(), stopped_again}) == 0);
  CHECK(Violations({Standing(), resumed}) == 0);
  CHECK(Violations({Standing(), resumed}, true) == 1);
}

TEST_CASE("no command is carried out after it has expired", "[launcher][soak]") {
  RobotCommand command;
  command.robot = "r1";
  command.lease_epoch = 2;
  command.sequence_number = 7;
  command.expires_at = SimTime::FromSeconds(10.0);
  const auto violations = [&](double at_s, CommandOutcome outcome) {
    Invariants invariants;
    invariants.See(command, "planner");
    RobotState state;
    state.robot = "r1";
    state.stamp = SimTime::FromSeconds(at_s);
    state.lease_epoch = 2;
    state.command_sequence_number = 7;
    state.command_outcome = outcome;
    invariants.See(state);
    return invariants.count();
  };
  CHECK(violations(10.25, CommandOutcome::kRunning) == 0);
  CHECK(violations(10.5, CommandOutcome::kRunning) == 1);
  CHECK(violations(10.5, CommandOutcome::kExpired) == 0);
}

TEST_CASE("a robot has one lease holder, and its epoch does not go back", "[launcher][soak]") {
  const auto lease = [](const std::string& instance, std::uint64_t epoch) {
    PlannerLease lease;
    lease.instance = instance;
    lease.holds = {{"r1", epoch}};
    return lease;
  };
  const Clock::TimePoint start{};
  Invariants invariants;
  invariants.See(lease("a", 1), start);
  invariants.See(lease("a", 1), start + 60s);
  invariants.See(lease("b", 2), start + 60s);
  invariants.See(lease("a", 1), start + 61s);  // it does not know of b yet
  CHECK(invariants.count() == 0);
  invariants.See(lease("a", 1), start + 60s + Invariants::kLeaseLag + 1s);
  CHECK(invariants.count() == 1);
  invariants.See(lease("c", 2), start + 70s);  // of two the highest instance
  CHECK(invariants.count() == 1);
  invariants.See(lease("b", 2), start + 70s + Invariants::kLeaseLag + 1s);
  CHECK(invariants.count() == 2);
  RobotCommand command;
  command.robot = "r1";
  command.lease_epoch = 2;
  invariants.See(command, "b");
  invariants.See(command, "b");
  CHECK(invariants.count() == 2);
  invariants.See(command, "c");
  CHECK(invariants.count() == 3);
  RobotState newer;
  newer.robot = "r1";
  newer.lease_epoch = 3;
  RobotState older = newer;
  older.lease_epoch = 2;
  CHECK(Violations({older, newer}) == 0);
  CHECK(Violations({newer, older}) == 1);
}

TEST_CASE("accepted edits have an order, and the published map has them", "[launcher][soak]") {
  const auto edit = [](std::uint64_t base, std::uint64_t revision, std::uint64_t known) {
    return AcceptedEdit{"anna", 1, "w1", {base, {{{1, 1}, true}}}, revision, known};
  };
  const auto violations = [](const std::vector<AcceptedEdit>& edits) {
    Invariants invariants;
    for (const AcceptedEdit& one : edits) invariants.See(one);
    return invariants.count();
  };
  CHECK(violations({edit(0, 1, 0), edit(1, 2, 1), edit(6, 7, 2)}) == 0);
  CHECK(violations({edit(0, 2, 0)}) == 1);
  CHECK(violations({edit(4, 5, 5)}) == 1);
  CHECK(violations({edit(0, 1, 0), edit(0, 1, 0)}) == 1);

  Invariants invariants;
  invariants.See(edit(0, 1, 0));
  CHECK(invariants.revision("w1") == 1);
  Belief belief;
  belief.world = "w1";
  belief.wall_probability = BeliefGrid(3, 3, 0.0F);
  invariants.See(belief);
  belief.revision = 1;
  belief.wall_probability[{1, 1}] = 1.0F;
  invariants.See(belief);
  CHECK(invariants.count() == 0);
  belief.wall_probability[{1, 1}] = 0.0F;
  invariants.See(belief);
  CHECK(invariants.count() == 1);
  belief.revision = 0;
  invariants.See(belief);
  CHECK(invariants.count() == 2);
}

TEST_CASE("the database is compared with what was acknowledged", "[launcher][soak]") {
  const test::TemporaryFolder folder;
  const BeliefGrid initial = DrawnMap({"####", "#  #", "#? #", "####"});
  std::vector<AcceptedEdit> edits{{"anna", 1, "w1", {0, {{{1, 1}, true}}}, 1, 0},
                                  {"anna", 2, "w1", {1, {{{1, 2}, true}, {{1, 1}, false}}}, 2, 1}};
  {
    operators::BeliefStore store({{folder / "operator.db", 0}, {}});
    REQUIRE(store.AddWorld("w1", initial, {1}));
    for (const AcceptedEdit& edit : edits) {
      REQUIRE(
          store.Handle({{2}, edit.client, edit.request_id, "w1", edit.edit}, {2}).reply.accepted);
    }
    // Of another client, of which nothing is known here.
    REQUIRE(
        store.Handle({{2}, "bert", 1, "w1", EditRequest{2, {{{2, 2}, true}}}}, {2}).reply.accepted);
  }
  const auto violations = [&](const std::string& change = "") {
    std::filesystem::copy_file(folder / "operator.db", folder / "copy.db",
                               std::filesystem::copy_options::overwrite_existing);
    auto copy = operators::Database::Open({folder / "copy.db", 0});
    REQUIRE(copy);
    if (!change.empty()) REQUIRE(copy->Execute(change));
    copy = Fail(ErrorCode::kNotFound, "closed");
    Invariants invariants;
    for (const AcceptedEdit& edit : edits) invariants.See(edit);
    CheckJournal(folder / "copy.db", invariants);
    return invariants.count();
  };
  CHECK(violations() == 0);
  CHECK(violations("DELETE FROM requests WHERE client = 'anna' AND request_id = 2") == 3);
  CHECK(violations("UPDATE requests SET revision = 9 WHERE request_id = 2") > 1);
  CHECK(violations("DELETE FROM requests WHERE client = 'bert'") == 1);
  CHECK(violations("DROP TABLE requests") == 1);
}

TEST_CASE("memory's slope is that within each life of a process", "[launcher][soak]") {
  const auto sample = [](pid_t pid, double at_s, double rss_mb) {
    return ProcessSample{"planner", pid, at_s, rss_mb, 10, 4};
  };
  CHECK(*RssSlope(std::vector{sample(1, 0, 50), sample(1, 1800, 51), sample(1, 3600, 52)}) ==
        Approx(2.0));
  CHECK(*RssSlope(std::vector{sample(1, 0, 50), sample(1, 3600, 53), sample(2, 7200, 20),
                              sample(2, 10800, 21)}) == Approx(2.0));
  CHECK_FALSE(RssSlope({}));
  CHECK_FALSE(RssSlope(std::vector{sample(1, 0, 50), sample(2, 1, 60)}));
  const auto own = SampleProcess("test", getpid(), 0.0);
  REQUIRE(own);
  CHECK(own->rss_mb > 1.0);
  CHECK(own->fds > 2);
  CHECK(own->threads >= 1);
  CHECK_FALSE(SampleProcess("none", -1, 0.0));
}

}  // namespace
}  // namespace conav::launcher
