#include "operator/simulated/synthetic_operator.h"

#include <algorithm>
#include <catch2/catch.hpp>

#include "common/runtime/config.h"
#include "unit/operator/support/synthetic_fixture.h"

namespace conav::operators {
namespace {

using namespace std::chrono_literals;

TEST_CASE("The first path is given when belief and state are there, after the time to think",
          "[simulated]") {
  Console console;
  console.person.Receive(StateAt({1, 1}, 10));
  console.ExpectNothing();
  console.person.Receive(MapAt(0));
  const GuideRequest guide = console.ExpectGuide();
  CHECK(guide.robot == "r1");
  CHECK(guide.path == std::vector<Cell>{{1, 1}, {1, 2}, {1, 3}, {1, 4}});
  CHECK(guide.answers_snapshot == 0);
  CHECK(guide.valid_for_s == 1800.0);
  console.ExpectNothing();  // one request at a time
  console.Accept(1);
  console.ExpectNothing();
  CHECK(console.person.counts().guidance == 1);
  SyntheticOperatorParameters parameters = Flawless();
  parameters.thinking_time_s = 3.0;
  Console thinking(parameters);
  thinking.ShowRobot();
  thinking.ExpectNothingFor(3s);
  thinking.ExpectGuide();
  Console silent(ParametersOfKind("silent"));
  silent.ShowRobot();
  silent.Show(SnapshotOf(1, 20));
  silent.ExpectNothing();
  CHECK(silent.person.open() == 0);
}

TEST_CASE("A picture or a request for attention is answered on the newest map and state",
          "[simulated]") {
  BegunConsole console;
  SECTION("A picture that shows an error is answered by an edit, then by a path on the new map") {
    console.Show(SnapshotOf(1, 20));
    CHECK(console.ExpectEdit() == EditRequest{0, {{{1, 3}, true}}});
    console.Accept(1);
    console.ExpectNothing();  // the edit counts only when the service has echoed it
    console.person.Receive(MapAt(1, {{1, 3}}));
    const GuideRequest guide = console.ExpectGuide();
    CHECK(guide.answers_snapshot == 1);
    // Around the block: 7 steps instead of 2 and a crossing.
    CHECK(guide.path.size() == 8);
    CHECK(console.person.counts().edits == 1);
  }
  SECTION("A refused edit is made again on the new map, where it is still a change") {
    Snapshot snapshot = SnapshotOf(1, 20);
    snapshot.visible.walls = {{1, 3}, {3, 2}};
    console.Show(snapshot);
    CHECK(console.ExpectEdit() == EditRequest{0, {{{1, 3}, true}, {{3, 2}, true}}});
    console.Refuse(1);
    console.clock.Advance(1s);
    console.ExpectNothing();                     // revision 1 has not arrived
    console.person.Receive(MapAt(1, {{3, 2}}));  // somebody else did that
    CHECK(console.ExpectEdit() == EditRequest{1, {{{1, 3}, true}}});
  }
  SECTION("A robot without guidance, or one that another robot blocks, gets a path and no wall") {
    console.person.Receive(StateAt({1, 2}, 20));
    console.Ask(Attention(AttentionReason::kNoGuidance, {1, 2}, 0, 20));
    CHECK(console.ExpectGuide().path == std::vector<Cell>{{1, 2}, {1, 3}, {1, 4}});
    console.Accept(2);
    RobotState state = StateAt({1, 2}, 30);
    state.command_outcome = CommandOutcome::kOccupied;
    state.command_cell = {1, 3};
    console.person.Receive(state);
    console.Ask(Attention(AttentionReason::kBlocked, {1, 3}, 0, 30, 2));
    console.ExpectGuide();
  }
  SECTION("A repeated attention request is answered once, a newer one replaces an older one") {
    const auto ask = Attention(AttentionReason::kNoGuidance, {1, 1}, 0, 10);
    console.Ask(ask);
    console.Ask(ask);
    console.Ask(Attention(AttentionReason::kNoGuidance, {1, 1}, 0, 10, 2));
    console.ExpectGuide();
    console.Accept(2);
    console.ExpectNothing();
    CHECK(console.person.open() == 0);
  }
}

TEST_CASE("A config names a kind of person and may change single values", "[simulated]") {
  SyntheticOperatorParameters person;
  ReadConfig(YAML::Load("{kind: hasty, reader: {edit_limit: 5}}"), "person", person);
  CHECK(person.reader.edit_limit == 5);
  CHECK(person.planner.horizon == "next_goal");
  CHECK(person.reader.edit_probability < SnapshotReaderParameters().edit_probability);
  CHECK(ParametersOfKind("wrong").planner.horizon == "away");
  CHECK(ParametersOfKind("wrong").reader.edit_probability == 0.0);
  CHECK_THROWS_WITH(ReadConfig(YAML::Load("{kind: grumpy}"), "person", person),
                    Catch::Contains("person.kind") && Catch::Contains("careful"));
}

TEST_CASE("A picture is answered by a path from the newest place of the robot to its goals",
          "[simulated]") {
  BegunConsole console;
  Snapshot snapshot = SnapshotOf(1, 20);
  snapshot.visible = {};
  snapshot.cell = {3, 1};
  snapshot.goals_left = {{3, 2}};
  console.Show(snapshot);
  const GuideRequest guide = console.ExpectGuide();
  CHECK(guide.path == std::vector<Cell>{{3, 1}, {3, 2}});
  CHECK(guide.answers_snapshot == 1);
  console.Accept(2);

  snapshot.sequence_number = 2;
  console.person.Receive(StateAt({1, 3}, 25));
  console.Show(snapshot);
  CHECK(console.ExpectGuide().path == std::vector<Cell>{{1, 3}, {1, 4}});
  console.Accept(3);

  snapshot = SnapshotOf(3, 30);
  snapshot.visible = {};
  snapshot.goals_left.clear();  // all are reached; an answer comes all the same
  console.Show(snapshot);
  CHECK(console.ExpectGuide().path == std::vector<Cell>{{1, 1}});
}

TEST_CASE("A goal that a picture shows is given to the robot, and the path leads there",
          "[simulated]") {
  SyntheticOperatorParameters parameters = Flawless();
  parameters.marks_goals = true;
  Console console(parameters);
  RobotState state = StateAt({1, 1}, 10);
  state.goals_left = {};
  const Position goal = state.grid.CellToPosition({1, 3});
  console.person.ReceiveGoalObjects("r1", {goal, state.grid.CellToPosition({3, 3})});
  console.person.Receive(MapAt(0));
  console.person.Receive(state);
  console.ExpectGuide();
  console.Accept(1);
  Snapshot snapshot = SnapshotOf(1, 20);
  snapshot.goals_left = {};
  snapshot.visible = {.free = {{1, 2}, {1, 3}}, .walls = {}};
  console.Show(snapshot);
  const auto ask = console.person.Next(console.clock.Now());
  REQUIRE(ask);
  CHECK(std::get<GoalsRequest>(ask->body) == GoalsRequest{"r1", {goal}, {}});
  console.Accept(1);
  CHECK(console.ExpectGuide().path.back() == Cell{1, 3});
  console.Accept(2);
  snapshot.sequence_number = 2;
  console.Show(snapshot);
  console.ExpectGuide();  // it is given once
}

TEST_CASE("A picture that is shown again is looked at once", "[simulated]") {
  BegunConsole console;
  console.Show(SnapshotOf(1, 20));
  console.Show(SnapshotOf(1, 20));
  CHECK(console.person.open() == 1);
}

TEST_CASE("Of more pictures than a person remembers the oldest are given up", "[simulated]") {
  BegunConsole console;
  constexpr std::uint64_t kShown = SyntheticOperator::kMostWaiting + 7;
  for (std::uint64_t number = 1; number <= kShown; ++number) {
    Snapshot snapshot = SnapshotOf(number, 20);
    snapshot.visible = {};
    console.Show(snapshot);
  }
  console.Ask(Attention(AttentionReason::kNoGuidance, {1, 1}, 7, 10));
  CHECK(console.person.open() == SyntheticOperator::kMostWaiting + 1);
  CHECK(console.person.counts().given_up == 7);
  CHECK(console.ExpectGuide().answers_snapshot == 8);  // the oldest that is left
}

TEST_CASE("A glance at a share of streamed pictures edits and gives no path", "[simulated]") {
  SyntheticOperatorParameters parameters = Flawless();
  parameters.glance_rate = 0.3;
  BegunConsole console(parameters);
  int edits = 0;
  for (std::uint64_t i = 1; i <= 2000; ++i) {
    console.Show(SnapshotOf(i, 20, true));
    const auto ask = console.person.Next(console.clock.Now());
    if (!ask) continue;
    REQUIRE(std::holds_alternative<EditRequest>(ask->body));
    ++edits;
    console.Accept(0);  // the map never changes here
  }
  CHECK(edits == Approx(600).margin(60));
  CHECK(console.person.open() == 0);
}

TEST_CASE("Refused guidance is asked for again after ever longer pauses, and given up in the end",
          "[simulated]") {
  SyntheticOperatorParameters parameters = Flawless();
  parameters.attempts = 3;
  Console console(parameters);
  console.ShowRobot();
  console.ExpectGuide();
  console.Refuse(0);
  console.ExpectNothingFor(100ms);
  console.ExpectGuide();
  console.Refuse(0);
  console.ExpectNothingFor(200ms);
  console.ExpectGuide();
  console.person.Answered(Fail(ErrorCode::kTimeout, "no reply"), console.clock.Now());
  CHECK(console.person.open() == 0);
  CHECK(console.person.counts().given_up == 1);
  CHECK(console.person.counts().newest_problem == "no reply");
}

TEST_CASE("What belongs to others is left alone, a robot outside of the map gets an empty path",
          "[simulated]") {
  BegunConsole console;
  console.person.Receive(StateAt({1, 1}, 10, "r9"));
  RobotState elsewhere = StateAt({1, 1}, 10);
  elsewhere.world = "w2";
  console.person.Receive(elsewhere);
  Snapshot snapshot = SnapshotOf(1, 20);
  snapshot.robot = "r9";
  console.Show(snapshot);
  console.person.Receive(Guidance{.world = "w1", .robot = "r1", .answers_snapshot = 3});
  console.Show(SnapshotOf(3, 20));
  console.ExpectNothing();
  CHECK(console.person.open() == 0);
  console.Show(SnapshotOf(4, 21));
  console.ExpectEdit();
  Console outside;
  outside.person.Receive(MapAt(0));
  outside.person.Receive(StateAt({99, 1}, 10));
  CHECK(outside.ExpectGuide().path.empty());
  CHECK(outside.person.counts().newest_problem.find("(99,1)") != std::string::npos);
}

/// Edits of r1's pictures, when r2's pictures come `r2_first` before or after.
std::vector<std::vector<CellEdit>> EditsOfR1(bool r2_first) {
  SyntheticOperatorParameters parameters = Flawless();
  parameters.reader.edit_probability = 0.5;
  Console console(parameters, {{"r1", "w1"}, {"r2", "w1"}});
  console.person.Receive(MapAt(0));
  std::vector<std::vector<CellEdit>> edits;
  for (std::uint64_t i = 1; i <= 40; ++i) {
    edits.emplace_back();
    for (const bool is_r2 : {r2_first, !r2_first}) {
      Snapshot snapshot = SnapshotOf(i, 20, true);
      if (is_r2) snapshot.robot = "r2";
      console.Show(snapshot);
      const auto ask = console.person.Next(console.clock.Now());
      if (!ask) continue;
      if (!is_r2) edits.back() = std::get<EditRequest>(ask->body).edits;
      console.Accept(0);
    }
  }
  return edits;
}

TEST_CASE("The reading of a robot's pictures does not depend on other robots", "[simulated]") {
  const auto edits = EditsOfR1(true);
  CHECK(edits == EditsOfR1(false));
  CHECK(std::count(edits.begin(), edits.end(), std::vector<CellEdit>{}) > 5);
  CHECK(std::count(edits.begin(), edits.end(), std::vector<CellEdit>{}) < 35);
}

TEST_CASE("A blocked cell becomes a wall for certain and the next path avoids it", "[simulated]") {
  SyntheticOperatorParameters parameters = Flawless();
  parameters.planner.wall_crossing_cost = 0.0;
  BegunConsole console(parameters);
  console.Ask(Attention(AttentionReason::kBlocked, {1, 2}, 0, 10));
  CHECK(console.ExpectEdit() == EditRequest{0, {{{1, 2}, true}}});
  console.Accept(1);
  console.person.Receive(MapAt(1, {{1, 2}}));
  // Crossing walls is free here, but not this one.
  CHECK(console.ExpectGuide().path ==
        std::vector<Cell>{{1, 1}, {2, 1}, {2, 2}, {2, 3}, {1, 3}, {1, 4}});
  console.Accept(2);

  // A picture that seems to show it free does not make the person forget.
  Snapshot snapshot = SnapshotOf(1, 20);
  snapshot.visible = {{{1, 2}}, {}};
  console.Show(snapshot);
  console.ExpectGuide();
}

TEST_CASE("An attention request waits for its pictures and state, for a while if they never come",
          "[simulated]") {
  BegunConsole alone;
  alone.Ask(Attention(AttentionReason::kNoGuidance, {1, 1}, 2, 30));
  alone.ExpectNothingFor(2s);
  CHECK(alone.ExpectGuide().answers_snapshot == 0);
  BegunConsole console;
  console.Ask(Attention(AttentionReason::kNoGuidance, {1, 1}, 2, 30));
  console.ExpectNothing();
  Snapshot first = SnapshotOf(1, 20, true);
  first.visible = {};
  console.Show(first);
  console.ExpectNothing();
  console.Show(SnapshotOf(2, 20, true));
  CHECK(console.ExpectEdit().edits.size() == 1);
  console.Accept(0);
  console.ExpectNothing();
  console.person.Receive(StateAt({1, 2}, 30));
  const GuideRequest guide = console.ExpectGuide();
  CHECK(guide.path.front() == Cell{1, 2});
  CHECK(guide.answers_snapshot == 2);
}

SyntheticOperatorParameters FollowingTheQueue() {
  SyntheticOperatorParameters parameters{.reader = FlawlessReader(), .order = "queue"};
  parameters.interaction = {.picture_s = 4.0, .blocked_s = 8.0, .path_s = 12.0, .log_sd = 0.0};
  return parameters;
}

AttentionItem Line(const std::string& robot, AttentionReason reason,
                   std::uint64_t newest_snapshot = 0) {
  return {.world = "w1", .robot = robot, .reason = reason, .newest_snapshot = newest_snapshot};
}

AttentionQueueState Queue(std::uint64_t revision, std::vector<AttentionItem> items) {
  return {{0}, revision, "priority", std::move(items), {}};
}

/// Two robots that both have a first path to wait for.
struct QueueFixture : Console {
  QueueFixture() : Console(FollowingTheQueue(), {{"r1", "w1"}, {"r2", "w1"}}) {
    person.Receive(MapAt(0));
    person.Receive(StateAt({1, 1}, 10, "r1"));
    person.Receive(StateAt({3, 1}, 10, "r2"));
    person.Receive(SimTime::FromSeconds(100));
  }
};

TEST_CASE("The first of the queue that can be dealt with is selected, then answered after its time",
          "[simulated]") {
  QueueFixture console;
  console.ExpectNothing();  // without a queue
  console.person.Receive(
      Queue(1, {Line("r2", AttentionReason::kFirstPath), Line("r1", AttentionReason::kFirstPath)}));
  CHECK(console.ExpectSelect() == SelectRequest{"r2", AttentionReason::kFirstPath});
  console.ExpectNothing();
  console.Accept(0);
  console.person.Receive(SimTime::FromSeconds(111.9));
  console.ExpectNothing();
  console.person.Receive(SimTime::FromSeconds(112));
  CHECK(console.ExpectGuide().robot == "r2");
  console.Accept(1);
  CHECK(console.ExpectSelect() == SelectRequest{"r1", AttentionReason::kFirstPath});
  QueueFixture passing;
  AttentionItem taken = Line("r2", AttentionReason::kFirstPath);
  taken.selected_by = "bert";
  passing.person.Receive(Queue(1, {Line("r1", AttentionReason::kSnapshot, 1), taken,
                                   Line("r1", AttentionReason::kFirstPath)}));
  CHECK(passing.ExpectSelect() == SelectRequest{"r1", AttentionReason::kFirstPath});
}

TEST_CASE("A refused selection is given up until the queue changes, a withdrawn question for good",
          "[simulated]") {
  QueueFixture console;
  console.person.Receive(Queue(1, {Line("r1", AttentionReason::kFirstPath)}));
  console.ExpectSelect();
  console.Refuse(0);
  console.ExpectNothing();
  CHECK(console.person.open() == 2);
  console.person.Receive(Queue(2, {Line("r2", AttentionReason::kFirstPath)}));
  CHECK(console.ExpectSelect() == SelectRequest{"r2", AttentionReason::kFirstPath});
  console.Refuse(0);
  console.Ask(Attention(AttentionReason::kBlocked, {1, 2}, 0, 10, 1));
  console.Ask(Attention(AttentionReason::kNone, {1, 1}, 0, 12, 1));
  console.person.Receive(Queue(3, {Line("r1", AttentionReason::kBlocked)}));
  console.ExpectNothing();
}

TEST_CASE("A blocked robot is answered with what its newest streamed picture shows besides",
          "[simulated]") {
  QueueFixture console;
  console.Show(SnapshotOf(1, 11, true));
  console.person.Receive(Queue(1, {}));
  console.ExpectNothing();  // a stream is looked at while its robot is attended to
  console.Ask(Attention(AttentionReason::kBlocked, {2, 1}, 1, 10));
  console.person.Receive(Queue(2, {Line("r1", AttentionReason::kBlocked)}));
  CHECK(console.ExpectSelect() == SelectRequest{"r1", AttentionReason::kBlocked});
  console.Accept(0);
  console.person.Receive(SimTime::FromSeconds(108));
  CHECK(console.ExpectEdit().edits == std::vector<CellEdit>{{{2, 1}, true}, {{1, 3}, true}});
}

TEST_CASE("Log-normal interaction times have the mean that was given", "[simulated]") {
  SyntheticOperatorParameters parameters = FollowingTheQueue();
  parameters.interaction.log_sd = 0.5;
  Console console(parameters);
  console.ShowRobot();
  double now_s = 100.0;
  console.person.Receive(SimTime::FromSeconds(now_s));
  constexpr int kMatters = 2000;
  double total_s = 0.0;
  for (int i = 1; i <= kMatters; ++i) {
    const auto number = static_cast<std::uint64_t>(i);
    console.Ask(Attention(AttentionReason::kNoGuidance, {1, 1}, 0, 10, number));
    console.person.Receive(Queue(number, {Line("r1", AttentionReason::kNoGuidance)}));
    REQUIRE(console.person.Next(console.clock.Now()));
    console.Accept(0);
    const double start_s = now_s;
    std::optional<OperatorAsk> ask;
    while (!(ask = console.person.Next(console.clock.Now()))) {
      now_s += 0.1;
      console.person.Receive(SimTime::FromSeconds(now_s));
    }
    console.Accept(1);
    total_s += now_s - start_s;
  }
  CHECK(total_s / kMatters == Approx(12.05).margin(0.5));  // 6 / sqrt(2000) = 0.14 s of error
}

TEST_CASE("a person corrects the whole wing once an error of it explains what pictures show",
          "[simulated]") {
  BeliefGrid truth(9, 9, 1.0F);
  for (const Cell cell : {Cell{1, 1}, Cell{1, 2}, Cell{1, 3}, Cell{2, 1}, Cell{3, 1}, Cell{3, 2}}) {
    truth[cell] = 0.0F;
  }
  const BeliefGrid wrong = WithError(truth, Wing{0, WingError::kMirrored});
  WingInference wings(wrong);
  CHECK(wings.See({.free = {{1, 1}, {1, 2}}, .walls = {}}, wrong).empty());  // too little evidence
  const auto edits = wings.See({.free = {{1, 3}, {2, 1}}, .walls = {}}, wrong);
  BeliefGrid mended = wrong;
  for (const CellEdit& edit : edits) mended[edit.cell] = edit.wall ? 1.0F : 0.0F;
  CHECK(mended == truth);
  CHECK(wings.See({.free = {{3, 1}}, .walls = {}}, mended).empty());  // believed once
  WingInference right(truth);
  CHECK(right.See({.free = {{1, 1}, {1, 2}, {1, 3}, {2, 1}}, .walls = {{1, 4}}}, truth).empty());
}

}  // namespace
}  // namespace conav::operators
