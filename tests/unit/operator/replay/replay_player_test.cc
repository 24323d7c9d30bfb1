#include <limits>

#include "operator/replay/timeline.h"
#include "support/packed_grid.h"
#include "unit/operator/replay/run_bench.h"

namespace conav::operators {
namespace {

TEST_CASE(
    "a replay begins paused with the first messages, plays at its speed and pauses at the end",
    "[operator][replay]") {
  const ReplayBench paused;
  CHECK(paused.Revision() == 0);
  CHECK(AllOf(paused.log, Kind::kRobot).empty());
  CHECK(paused.Playback().duration() == 10.0);
  CHECK(paused.Playback().speed() == 0.0);
  CHECK(paused.Playback().marks_size() == 6);
  const auto truth = OnlyOf(paused.log, Kind::kTruth).truth();
  CHECK(test::UnpackedCells(truth.cells())[5] == 2);
  const auto belief = OnlyOf(paused.log, Kind::kBelief).belief();
  CHECK(test::UnpackedCells(belief.walls())[5] == 0);
  ReplayBench bench;
  bench.Advance(5.0);
  CHECK(bench.player.position_s() == 0.0);
  bench.player.Seek(std::nullopt, 2.0, bench.now_s);
  bench.Advance(1.25);
  CHECK(bench.player.position_s() == 2.5);
  CHECK(bench.Playback().position() == 2.5);
  CHECK(bench.Robot().cell().column() == 2);
  bench.Advance(100.0);
  CHECK(bench.player.position_s() == 10.0);
  CHECK(bench.Playback().speed() == 0.0);
}

TEST_CASE("a replay shows the same at a place, however it came there", "[operator][replay]") {
  const double place = GENERATE(0.0, 2.5, 4.0, 9.0, 10.0);
  CAPTURE(place);
  ReplayBench straight;
  straight.Seek(place);
  ReplayBench back;
  back.Seek(10.0);
  back.Seek(place);
  CHECK(straight.Everything() == back.Everything());
  ReplayBench played;
  played.player.Seek(std::nullopt, 1.0, played.now_s);
  while (played.player.position_s() < place) played.Advance(0.25);
  CHECK(played.player.position_s() == place);
  CHECK(played.Revision() == straight.Revision());
  CHECK(played.Snapshots() == straight.Snapshots());
  CHECK(played.Cells() == straight.Cells());
}

TEST_CASE("pictures come and go with the place, and their answers", "[operator][replay]") {
  ReplayBench bench;
  bench.Seek(3.5);
  CHECK(bench.Snapshots() == std::vector<std::uint64_t>{1});
  CHECK(OnlyOf(bench.log, Kind::kSnapshot).snapshot().answer() == console::ANSWER_NONE);
  REQUIRE(bench.snapshots.Find("r1", 1));
  CHECK(bench.snapshots.Find("r1", 2) == nullptr);
  bench.Seek(10.0);
  CHECK(bench.Snapshots() == std::vector<std::uint64_t>{1, 2});
  const auto snapshots = AllOf(bench.log, Kind::kSnapshot);
  CHECK(snapshots[0].snapshot().answer() == console::ANSWER_PATH);
  CHECK(snapshots[1].snapshot().answer() == console::ANSWER_NOTHING_NEW);
  bench.Seek(2.0);
  CHECK(bench.Snapshots().empty());
}

TEST_CASE("a seek back is a beginning for pages, a seek ahead is none", "[operator][replay]") {
  ReplayBench bench;
  bench.player.Receive({{"anna/1", "anna", console::ROLE_OPERATOR}});
  const auto generation = bench.log.generation();
  bench.Seek(9.0);
  CHECK(bench.log.generation() == generation);
  bench.Seek(4.0);
  CHECK(bench.log.generation() == generation + 1);
  CHECK(bench.Revision() == 1);
  CHECK(AllOf(bench.log, Kind::kEvent).size() == 1);
  CHECK(OnlyOf(bench.log, Kind::kPresence).presence().people_size() == 1);
  CHECK(bench.Playback().position() == 4.0);
}

TEST_CASE("a seek puts only the newest of what replaces each other", "[operator][replay]") {
  TimelineBuilder builder(SessionOfOne());
  for (int i = 0; i < 1000; ++i)
    builder.Receive(kBegin + i, BeliefOf(0, 0.001F * static_cast<float>(i)));
  ReplayBench bench(std::move(builder).Finish());
  const auto sequence = bench.log.sequence();
  bench.Seek(999.0);
  CHECK(bench.log.sequence() == sequence + 2);  // the belief and where we are
  const auto belief = OnlyOf(bench.log, Kind::kBelief).belief();
  CHECK(test::UnpackedCells(belief.walls())[5] == static_cast<char>(255));
}

TEST_CASE("the trail is whole after any seek", "[operator][replay]") {
  ReplayBench bench;
  for (const double place : {10.0, 5.0, 10.0}) {
    bench.Seek(place);
    const auto trail = OnlyOf(bench.log, Kind::kTrail).trail();
    REQUIRE(trail.cells_size() == 3);
    CHECK(trail.cells(2).column() == 3);
  }
}

TEST_CASE("a message is as old as at that place of the recording", "[operator][replay]") {
  ReplayBench bench;
  bench.Seek(7.0);
  CHECK(bench.Robot().received_at() == Approx(kNow - 2.0).margin(1e-3));
  CHECK(OnlyOf(bench.log, Kind::kSnapshot).snapshot().received_at() ==
        Approx(kNow - 4.0).margin(1e-3));
  SECTION("also while it pauses") {
    bench.Advance(60.0);
    CHECK(bench.Robot().received_at() == Approx(kNow + 58.0).margin(1e-3));
  }
  SECTION("also when it runs quicker") {
    bench.player.Seek(std::nullopt, 10.0, bench.now_s);
    bench.Advance(0.0625);  // at 7.625
    CHECK(bench.Robot().received_at() == Approx(bench.now_s - 2.625).margin(1e-3));
    const auto snapshot = OnlyOf(bench.log, Kind::kSnapshot).snapshot();
    CHECK(snapshot.received_at() == Approx(bench.now_s - 4.625).margin(1e-3));
  }
}

TEST_CASE("a replay shows what was true at its place", "[operator][replay]") {
  TimelineBuilder builder(SessionOfOne());
  SECTION("alerts are as old as at that place of the recording") {
    builder.Receive(kBegin, BeliefOf(0, 0.0F));
    builder.Receive(kBegin, ServiceHealth{"sim", console::LEVEL_OK, ""});
    builder.Receive(kBegin + 1.0, ServiceHealth{"sim", console::LEVEL_ERROR, "no camera"});
    builder.Receive(kBegin + 4.0, ServiceHealth{"sim", console::LEVEL_ERROR, "no camera"});
    ReplayBench bench(std::move(builder).Finish());
    bench.Seek(3.0);
    CHECK(OnlyOf(bench.log, Kind::kAlert).alert().raised() == Approx(kNow - 2.0).margin(1e-3));
    bench.Advance(60.0);
    CHECK(OnlyOf(bench.log, Kind::kAlert).alert().raised() == Approx(kNow + 58.0).margin(1e-3));
  }
  SECTION("streams show the newest frame, with where the robot is") {
    builder.Receive(kBegin, At(1, {1, 2}));
    for (std::uint8_t i = 0; i < 5; ++i) builder.ReceiveFrame(kBegin + i, {"r1", {}, {i}});
    ReplayBench bench(std::move(builder).Finish());
    bench.Seek(3.0);
    const auto slot = bench.frames.Newer({}).at("r1");
    CHECK(slot.frame->jpeg() == std::string(1, '\3'));
    CHECK(slot.frame->cell().column() == 2);
    CHECK(slot.number == 3);  // the first one, this, and this with its age
    CHECK(slot.frame->received_at() == Approx(kNow).margin(1e-3));
    bench.Advance(60.0);  // a pause
    CHECK(bench.frames.Newer({}).at("r1").frame->received_at() == Approx(kNow + 60.0).margin(1e-3));
  }
  SECTION("a world that restarted shows its own picture of a number") {
    Snapshot snapshot = SentSnapshot(1);
    snapshot.jpeg = {1, 2, 3};
    builder.Receive(kBegin, snapshot);
    snapshot.jpeg = {4, 5};
    builder.Receive(kBegin + 5.0, snapshot);
    ReplayBench bench(std::move(builder).Finish());
    bench.Seek(5.0);
    CHECK(*bench.snapshots.Find("r1", 1) == std::vector<std::uint8_t>{4, 5});
    bench.Seek(0.0);
    CHECK(*bench.snapshots.Find("r1", 1) == std::vector<std::uint8_t>{1, 2, 3});
  }
  SECTION("a robot that was stopped is shown so, since then") {
    builder.Receive(kBegin, StopOrder{{}, "w1", "r1", 1, true, "anna/1", "a cat"});
    builder.Receive(kBegin + 5.0, StopOrder{{}, "w1", "r1", 2, false, "anna/1", ""});
    ReplayBench bench(std::move(builder).Finish());
    bench.Seek(2.0);
    const auto control = OnlyOf(bench.log, Kind::kControl).control();
    CHECK(control.stopped());
    CHECK(control.stopped_by() == "anna/1");
    CHECK(control.stop_reason() == "a cat");
    bench.Seek(5.0);
    CHECK_FALSE(OnlyOf(bench.log, Kind::kControl).control().stopped());
  }
}

TEST_CASE("a place that is none is left alone or the nearest one", "[operator][replay]") {
  ReplayBench bench;
  bench.Seek(4.0);
  bench.Seek(std::numeric_limits<double>::quiet_NaN());
  CHECK(bench.player.position_s() == 4.0);
  bench.Seek(-1.0);
  CHECK(bench.player.position_s() == 0.0);
  bench.Seek(1e300);
  CHECK(bench.player.position_s() == 10.0);
  bench.player.Seek(std::nullopt, std::numeric_limits<double>::infinity(), bench.now_s);
  CHECK(bench.player.speed() == 0.0);
  bench.player.Seek(std::nullopt, 1e9, bench.now_s);
  CHECK(bench.player.speed() == ReplayPlayer::kFastest);
  bench.player.Seek(std::nullopt, -2.0, bench.now_s);
  CHECK(bench.player.speed() == 0.0);
}

}  // namespace
}  // namespace conav::operators
