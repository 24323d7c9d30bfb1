#include "operator/console/console_state.h"

#include "operator/console/console_messages.h"
#include "support/packed_grid.h"
#include "unit/operator/console/state_bench.h"

namespace conav::operators {
namespace {

TEST_CASE("a robot appears with its newest state", "[operator][console]") {
  StateBench bench;
  bench.state.Receive(At(1, {1, 1}), 100.0);
  bench.state.Receive(At(2, {1, 2}), 101.0);
  const auto robot = OnlyOf(bench.log, Kind::kRobot).robot();
  CHECK(robot.name() == "r1");
  CHECK(robot.stamp() == 2.0);
  CHECK(robot.received_at() == 101.0);
  CHECK(bench.state.TimeOf("w1") == SimTime{2'000'000'000});
  CHECK(bench.state.TimeOf("w2") == SimTime{});
}

TEST_CASE("a world says its time with its size, five times a second", "[operator][console]") {
  StateBench bench;
  bench.state.Receive(At(1, {1, 1}), 100.0);
  CHECK(AllOf(bench.log, Kind::kWorld).empty());  // its size is not known yet
  bench.state.ReceiveGeometry("w1", MapOf(3, 4));
  const auto world = OnlyOf(bench.log, Kind::kWorld).world();
  CHECK(world.rows() == 3);
  CHECK(world.columns() == 4);
  CHECK(world.cell_size() == 2.0);
  CHECK(world.time() == 1.0);
  bench.state.Receive(At(2, {1, 1}), 100.3);
  CHECK(OnlyOf(bench.log, Kind::kWorld).world().time() == 2.0);
  bench.state.Receive(At(3, {1, 1}), 100.4);
  CHECK(OnlyOf(bench.log, Kind::kWorld).world().time() == 2.0);
  bench.state.Receive(At(4, {1, 1}), 50.0);  // somebody set the clock back
  CHECK(OnlyOf(bench.log, Kind::kWorld).world().time() == 4.0);
}

TEST_CASE("a robot whose time goes back is reset, with all robots of its world",
          "[operator][console]") {
  StateBench bench;
  for (const char* robot : {"r1", "r2"}) bench.state.Receive(At(9, {1, 1}, {}, robot), 0.0);
  bench.state.Receive(At(9, {1, 1}, {}, "r3", "w2"), 0.0);
  bench.state.ReceiveSeen("r1", "w1", MapOf(2, 2));
  bench.state.ReceivePlan("r2", {}, {{1, 1}});
  bench.state.ReceiveGoalPose("r2", {1, 1}, 1.0);
  bench.state.Receive(ToConsole(SnapshotOf(1, "r3"), 0.0));
  bench.state.Receive(ToConsole(SnapshotOf(1), 0.0));
  const std::uint64_t generation = bench.log.generation();

  bench.state.Receive(At(3, {2, 2}), 0.0);

  CHECK(bench.log.generation() > generation);
  CHECK(AllOf(bench.log, Kind::kRobot).size() == 2);  // r1 again, and r3
  CHECK(bench.Trail() == "2,2");
  CHECK(AllOf(bench.log, Kind::kSeen).empty());
  CHECK(AllOf(bench.log, Kind::kPlan).empty());
  CHECK(AllOf(bench.log, Kind::kGoalPose).empty());
  CHECK(OnlyOf(bench.log, Kind::kSnapshot).snapshot().robot() == "r3");
  CHECK(bench.state.TimeOf("w1") == SimTime{3'000'000'000});
  CHECK(bench.state.TimeOf("w2") == SimTime{9'000'000'000});
  bench.state.ReceiveSeen("r1", "w1", MapOf(2, 2));  // as before, and said again
  CHECK(AllOf(bench.log, Kind::kSeen).size() == 1);
}

TEST_CASE("the operator's work outlives a run, and so does a map that came before its first state",
          "[operator][console]") {
  StateBench bench;
  bench.state.Receive(At(9, {1, 1}), 0.0);
  bench.state.ReceiveGeometry("w1", MapOf(3, 4));
  const Belief belief = samples::SampleBelief();
  bench.state.Receive(belief, belief.wall_probability);
  bench.state.Receive(Answering(0));
  bench.state.Receive(std::vector<Person>{{"anna/1", "anna", console::ROLE_OPERATOR}});
  bench.state.Receive(console::Event());
  bench.state.Receive(console::Alert());

  bench.state.Receive(At(3, {2, 2}), 1.0);

  CHECK(OnlyOf(bench.log, Kind::kBelief).belief().revision() == belief.revision);
  CHECK(OnlyOf(bench.log, Kind::kGuidance).guidance().robot() == "r1");
  CHECK(OnlyOf(bench.log, Kind::kPresence).presence().people_size() == 1);
  CHECK(AllOf(bench.log, Kind::kEvent).size() == 1);
  CHECK(AllOf(bench.log, Kind::kAlert).size() == 1);
  CHECK(OnlyOf(bench.log, Kind::kWorld).world().rows() == 3);
  CHECK(OnlyOf(bench.log, Kind::kWorld).world().time() == 3.0);
}

TEST_CASE("a reset leaves only the session, that of a robot none with a name that begins alike",
          "[operator][console]") {
  StateBench bench;
  bench.state.Receive(At(9, {1, 1}, {}, "r1", "w1"), 0.0);
  bench.state.Receive(At(9, {1, 1}, {}, "r10", "w2"), 0.0);
  bench.state.Receive(At(3, {1, 1}, {}, "r1", "w1"), 0.0);
  CHECK(AllOf(bench.log, Kind::kRobot).size() == 2);
  StateBench cleared;
  CHECK(OnlyOf(cleared.log, Kind::kSession).session().robots().empty());
  cleared.state.Receive(At(9, {1, 1}), 0.0);
  cleared.state.Receive(Answering(0));
  cleared.state.Reset();
  CHECK(AllOf(cleared.log).size() == 1);
  CHECK(cleared.state.TimeOf("w1") == SimTime{});
  cleared.state.Receive(At(3, {1, 1}), 0.0);
  CHECK(AllOf(cleared.log, Kind::kRobot).size() == 1);
}

TEST_CASE("a robot's map is sent when it changes", "[operator][console]") {
  StateBench bench;
  bench.state.ReceiveSeen("r1", "w1", MapOf(2, 2));
  const std::uint64_t before = bench.log.sequence();
  bench.state.ReceiveSeen("r1", "w1", MapOf(2, 2));
  CHECK(bench.log.sequence() == before);
  MapUpdate more = MapOf(2, 2);
  more.cells[{0, 1}] = Occupancy::kOccupied;
  bench.state.ReceiveSeen("r1", "w1", more);
  const auto seen = OnlyOf(bench.log, Kind::kSeen).seen();
  CHECK(seen.robot() == "r1");
  CHECK(seen.world() == "w1");
  CHECK(test::UnpackedCells(seen.cells()) == std::string("\x00\x02\x00\x00", 4));
}

TEST_CASE("beliefs, truth, plans, goal poses and predictions appear as they were received",
          "[operator][console]") {
  StateBench bench;
  const Belief belief = samples::SampleBelief();
  bench.state.Receive(belief, BeliefGrid(2, 3, 0.0F));
  const auto message = OnlyOf(bench.log, Kind::kBelief).belief();
  CHECK(message.world() == "w2");
  CHECK(message.revision() == 12);
  CHECK(message.edited_by() == "browser-1");
  CHECK(message.stamp() == Approx(belief.stamp.ToSeconds()));
  CHECK(message.walls() == Packed(belief.wall_probability));
  CHECK(test::UnpackedCells(message.initial_walls()) == std::string(6, '\0'));
  bench.state.ReceiveTruth("w1", OccupancyGrid(1, 2, Occupancy::kFree));
  bench.state.ReceivePlan("r1", {2'000'000'000}, {{1, 2}, {1, 3}});
  bench.state.ReceiveGoalPose("r1", {4, 5}, 6.0);
  bench.state.Receive("r1", "w1", 3, "nhpm", {Grid<float>(1, 2, 1.0F), Grid<float>(1, 2, 0.0F)});
  const auto truth = OnlyOf(bench.log, Kind::kTruth).truth();
  CHECK(test::UnpackedCells(truth.cells()) == "\x01\x01");
  CHECK(OnlyOf(bench.log, Kind::kPlan).plan().cells(1).column() == 3);
  CHECK(OnlyOf(bench.log, Kind::kPlan).plan().stamp() == 2.0);
  CHECK(OnlyOf(bench.log, Kind::kGoalPose).goal_pose().cell().row() == 4);
  const auto prediction = OnlyOf(bench.log, Kind::kPrediction).prediction();
  CHECK(prediction.snapshot() == 3);
  CHECK(prediction.model() == "nhpm");
  CHECK(test::UnpackedCells(prediction.add()) == "\xFF\xFF");
  CHECK(test::UnpackedCells(prediction.remove()) == std::string(2, '\0'));
}

TEST_CASE("health is said when it changes, the session learns its method", "[operator][console]") {
  StateBench bench;
  const ServiceHealth good{"planner", console::LEVEL_OK, "plans"};
  bench.state.Receive(good, 100.0);
  bench.state.Receive(good, 100.5);
  CHECK(OnlyOf(bench.log, Kind::kService).service().received_at() == 100.0);
  bench.state.Receive(good, 101.0);
  CHECK(OnlyOf(bench.log, Kind::kService).service().received_at() == 101.0);
  bench.state.Receive({"planner", console::LEVEL_ERROR, "lost"}, 101.1);
  const auto service = OnlyOf(bench.log, Kind::kService).service();
  CHECK(service.level() == console::LEVEL_ERROR);
  CHECK(service.message() == "lost");
  StateBench learning;
  SearchReport report = samples::SampleReport();
  learning.state.Receive(report);
  CHECK(OnlyOf(learning.log, Kind::kSession).session().method() == "ig-mcts");
  CHECK_FALSE((learning.state.session().drives() || learning.state.session().streams()));
  report.method = "teleop";
  learning.state.Receive(report);
  const auto session = OnlyOf(learning.log, Kind::kSession).session();
  CHECK((session.drives() && session.streams()));
}

TEST_CASE("alerts that nobody has read stay, however many others come and go",
          "[operator][console]") {
  StateBench bench;
  console::Alert open;
  open.set_id(1);
  bench.state.Receive(open);
  for (std::uint64_t id = 2; id < 3 + ConsoleState::kAlertsKept; ++id) {
    console::Alert alert;
    alert.set_id(id);
    alert.set_active(true);
    bench.state.Receive(alert);
    alert.set_active(false);
    alert.set_acknowledged_by("anna/1");
    bench.state.Receive(alert);
  }
  const auto alerts = AllOf(bench.log, Kind::kAlert);
  REQUIRE(alerts.size() == ConsoleState::kAlertsKept + 1);
  CHECK(alerts[0].alert().id() == 1);
  CHECK(alerts[1].alert().id() == 3);
}

TEST_CASE("searches, the queue, tasks, control, playback, alerts and people appear",
          "[operator][console]") {
  StateBench bench;
  bench.state.Receive(samples::SampleReport());
  bench.state.Receive(samples::SampleQueue());
  console::Update task;
  task.mutable_task();
  bench.state.ReceiveStep(std::move(task));
  bench.state.Receive(console::Control());
  bench.state.Receive(console::Playback());
  bench.state.Receive(std::vector<Person>{{"anna/1", "anna", console::ROLE_ADMIN}});
  console::Alert alert;
  for (const std::uint32_t count : {1, 2}) {
    alert.set_count(count);
    bench.state.Receive(alert);
  }
  CHECK(OnlyOf(bench.log, Kind::kSearch).search().decision() == 14);
  CHECK(OnlyOf(bench.log, Kind::kAttention).attention().items_size() == 2);
  for (const auto kind : {Kind::kTask, Kind::kControl, Kind::kPlayback}) OnlyOf(bench.log, kind);
  CHECK(OnlyOf(bench.log, Kind::kAlert).alert().count() == 2);
  const auto person = OnlyOf(bench.log, Kind::kPresence).presence().people(0);
  CHECK(person.client() == "anna/1");
  CHECK(person.name() == "anna");
  CHECK(person.role() == console::ROLE_ADMIN);
  bench.state.Receive(std::vector<Person>{});
  CHECK(OnlyOf(bench.log, Kind::kPresence).presence().people().empty());
}

TEST_CASE("a picture is open until it is answered or another one comes", "[operator][console]") {
  StateBench bench;
  SECTION("a picture is open until another one comes") {
    bench.state.Receive(ToConsole(SnapshotOf(1), 100.0));
    CHECK(bench.Answers() == Answers{console::ANSWER_NONE});
    bench.state.Receive(ToConsole(SnapshotOf(2), 101.0));
    CHECK(bench.Answers() == Answers{console::ANSWER_OUTDATED, console::ANSWER_NONE});
  }
  SECTION("guidance that names a picture answers it") {
    bench.state.Receive(ToConsole(SnapshotOf(1), 100.0));
    bench.state.Receive(Answering(0));
    CHECK(bench.Answers() == Answers{console::ANSWER_NONE});
    bench.state.Receive(Answering(1));
    const auto snapshot = OnlyOf(bench.log, Kind::kSnapshot).snapshot();
    CHECK(snapshot.answer() == console::ANSWER_PATH);
    CHECK(snapshot.answered_by() == "simulated_operator");
    CHECK(snapshot.received_at() == 100.0);
  }
  SECTION("a picture that is shown again stays open") {
    bench.state.Receive(ToConsole(SnapshotOf(1), 100.0));
    bench.state.Receive(ToConsole(SnapshotOf(1), 101.0));
    CHECK(bench.Answers() == Answers{console::ANSWER_NONE});
    bench.state.ReceiveAnswer("r1", 1, "anna/1");
    bench.state.Receive(ToConsole(SnapshotOf(1), 102.0));
    CHECK(bench.Answers() == Answers{console::ANSWER_NOTHING_NEW});
  }
  SECTION("nothing new answers a picture, too") {
    bench.state.Receive(ToConsole(SnapshotOf(1), 100.0));
    bench.state.ReceiveAnswer("r1", 1, "anna/1");
    CHECK(OnlyOf(bench.log, Kind::kSnapshot).snapshot().answer() == console::ANSWER_NOTHING_NEW);
    CHECK(OnlyOf(bench.log, Kind::kSnapshot).snapshot().answered_by() == "anna/1");
    bench.state.Receive(ToConsole(SnapshotOf(2), 101.0));
    CHECK(bench.Answers() == Answers{console::ANSWER_NOTHING_NEW, console::ANSWER_NONE});
  }
  SECTION("a picture that comes after its answer is not open") {
    // The service restarted: stored guidance first, then what robots sent before
    bench.state.Receive(Answering(2));
    for (const std::uint64_t number : {1U, 2U, 3U})
      bench.state.Receive(ToConsole(SnapshotOf(number), 0.0));
    CHECK(bench.Answers() ==
          Answers{console::ANSWER_OUTDATED, console::ANSWER_PATH, console::ANSWER_NONE});
  }
  SECTION("a robot that restarts its count of pictures has none answered") {
    bench.state.Receive(Answering(2));
    bench.state.Receive(At(1, {1, 1}), 0.0);
    bench.state.Receive(ToConsole(SnapshotOf(1), 0.0));
    CHECK(bench.Answers() == Answers{console::ANSWER_NONE});
  }
}

TEST_CASE("the newest pictures and events are kept", "[operator][console]") {
  StateBench bench;
  for (std::uint64_t i = 1; i <= ConsoleState::kSnapshotsKept + 5; ++i) {
    bench.state.Receive(ToConsole(SnapshotOf(i), 0.0));
  }
  const auto snapshots = AllOf(bench.log, Kind::kSnapshot);
  CHECK(snapshots.size() == ConsoleState::kSnapshotsKept);
  CHECK(snapshots.front().snapshot().sequence_number() == 6);
  for (std::size_t i = 0; i < ConsoleState::kEventsKept + 3; ++i) {
    bench.state.Receive(console::Event());
  }
  const auto events = AllOf(bench.log, Kind::kEvent);
  CHECK(events.size() == ConsoleState::kEventsKept);
  CHECK(events.front().event().id() == 4);
}

TEST_CASE("the newest picture can be received again, with its answer", "[operator][console]") {
  StateBench bench;
  bench.state.ReceiveSnapshotAgain("r1", 5.0);
  CHECK(AllOf(bench.log, Kind::kSnapshot).empty());
  bench.state.Receive(ToConsole(SnapshotOf(1), 10.0));
  bench.state.Receive(ToConsole(SnapshotOf(2), 11.0));
  bench.state.ReceiveSnapshotAgain("r1", 20.0);
  bench.state.ReceiveAnswer("r1", 2, "anna");
  const auto snapshots = AllOf(bench.log, Kind::kSnapshot);
  REQUIRE(snapshots.size() == 2);
  CHECK(snapshots[0].snapshot().received_at() == 10.0);
  CHECK(snapshots[1].snapshot().received_at() == 20.0);
  bench.state.ReceiveSnapshotAgain("r1", 30.0);
  const auto again = AllOf(bench.log, Kind::kSnapshot).back().snapshot();
  CHECK(again.received_at() == 30.0);
  CHECK(again.answer() == console::ANSWER_NOTHING_NEW);
}

TEST_CASE("a trail follows the robot cell by cell", "[operator][console]") {
  StateBench bench;
  SECTION("a trail follows the robot cell by cell") {
    bench.state.Receive(At(1, {1, 1}, {{1, 1}}), 0.0);
    bench.state.Receive(At(2, {1, 2}, {{1, 1}, {1, 2}}), 0.0);
    const std::uint64_t before = bench.log.sequence();
    bench.state.Receive(At(3, {1, 2}, {{1, 1}, {1, 2}}), 0.0);
    CHECK(bench.log.sequence() == before + 1);  // the state, and no trail
    bench.state.Receive(At(4, {2, 2}, {{1, 1}, {1, 2}, {2, 2}}), 0.0);
    CHECK(bench.Trail() == "1,1 1,2 2,2");
  }
  SECTION("a trail has the cells between two received states") {
    bench.state.Receive(At(1, {1, 1}, {{1, 1}}), 0.0);
    bench.state.Receive(At(5, {1, 3}, {{1, 1}, {1, 2}, {1, 1}, {1, 2}, {1, 3}}), 0.0);
    CHECK(bench.Trail() == "1,1 1,2 1,1 1,2 1,3");
    bench.state.Receive(At(9, {1, 3}, {{1, 1}, {1, 2}, {1, 1}, {1, 2}, {1, 3}, {1, 4}, {1, 3}}),
                        0.0);
    CHECK(bench.Trail() == "1,1 1,2 1,1 1,2 1,3 1,4 1,3");
  }
  SECTION("a trail goes on after a picture whose path was not received") {
    bench.state.Receive(At(1, {1, 1}, {{1, 1}}), 0.0);
    RobotState later = At(9, {5, 6}, {{5, 5}, {5, 6}});
    later.cell_moves = 20;
    bench.state.Receive(later, 0.0);
    CHECK(bench.Trail() == "1,1 5,5 5,6");
  }
  SECTION("a robot that does not count its moves has a trail, too") {
    const std::vector<std::vector<Cell>> paths{
        {{1, 1}}, {{1, 1}, {1, 2}, {1, 3}}, {}, {{1, 4}, {1, 5}}};
    const std::vector<Cell> cells{{1, 1}, {1, 3}, {1, 4}, {1, 5}};
    for (std::size_t i = 0; i < cells.size(); ++i) {
      RobotState state = At(static_cast<std::int64_t>(i), cells[i], paths[i]);
      state.cell_moves = 0;
      bench.state.Receive(state, 0.0);
    }
    CHECK(bench.Trail() == "1,1 1,2 1,3 1,4 1,5");
  }
  SECTION("a long trail comes in pieces, and only the last one again") {
    std::vector<Cell> path;
    for (int i = 0; i < 130; ++i) path.push_back({0, i});
    bench.state.Receive(At(1, path.back(), path), 0.0);
    CHECK(AllOf(bench.log, Kind::kTrail).size() == 3);
    const std::uint64_t before = bench.log.sequence();
    path.push_back({0, 130});
    bench.state.Receive(At(2, path.back(), path), 0.0);
    const auto fresh = Parsed(bench.log.After(bench.log.generation(), before, SIZE_MAX));
    REQUIRE(fresh.size() == 2);
    CHECK(fresh[0].trail().first() == 128);
    CHECK(fresh[0].trail().cells_size() == 3);
  }
  SECTION("of an endless trail the newest pieces are kept") {
    constexpr int kDriven = 2 * ConsoleState::kTrailPiecesKept * ConsoleState::kTrailPiece;
    for (int i = 0; i < kDriven; ++i) {
      const Cell cell{i / 100, i % 100};
      bench.state.Receive(At(i, cell, {cell}), 0.0);
    }
    const auto pieces = AllOf(bench.log, Kind::kTrail);
    REQUIRE(pieces.size() == ConsoleState::kTrailPiecesKept);
    CHECK(pieces.front().trail().first() == kDriven / 2);
    CHECK(bench.log.bytes() < ConsoleState::kTrailPiecesKept * ConsoleState::kTrailPiece * 16);
  }
}

}  // namespace
}  // namespace conav::operators
