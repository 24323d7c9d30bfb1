#include "unit/operator/console/state_bench.h"

namespace conav::operators {

TEST_CASE("a picture is open until another one comes", "[operator][console]") {
  StateBench bench;
  bench.state.Receive(ToConsole(SnapshotOf(1), 100.0));
  CHECK(bench.Answers() == Answers{console::ANSWER_NONE});
  bench.state.Receive(ToConsole(SnapshotOf(2), 101.0));
  CHECK(bench.Answers() == Answers{console::ANSWER_OUTDATED, console::ANSWER_NONE});
}

TEST_CASE("guidance that names a picture answers it", "[operator][console]") {
  StateBench bench;
  bench.state.Receive(ToConsole(SnapshotOf(1), 100.0));
  bench.state.Receive(Answering(0));
  CHECK(bench.Answers() == Answers{console::ANSWER_NONE});
  bench.state.Receive(Answering(1));
  const auto picture = OnlyOf(bench.log, Kind::kPicture).picture();
  CHECK(picture.answer() == console::ANSWER_PATH);
  CHECK(picture.answered_by() == "simulated_operator");
  CHECK(picture.heard_at() == 100.0);
}

TEST_CASE("nothing new answers a picture, too", "[operator][console]") {
  StateBench bench;
  bench.state.Receive(ToConsole(SnapshotOf(1), 100.0));
  bench.state.ReceiveAnswer("r1", 1, "anna/1");
  CHECK(OnlyOf(bench.log, Kind::kPicture).picture().answer() == console::ANSWER_NOTHING_NEW);
  CHECK(OnlyOf(bench.log, Kind::kPicture).picture().answered_by() == "anna/1");
  bench.state.Receive(ToConsole(SnapshotOf(2), 101.0));
  CHECK(bench.Answers() == Answers{console::ANSWER_NOTHING_NEW, console::ANSWER_NONE});
}

TEST_CASE("a picture that comes after its answer is not open", "[operator][console]") {
  StateBench bench;  // the service began anew: stored guidance first, then what robots sent before
  bench.state.Receive(Answering(2));
  for (const std::uint64_t number : {1U, 2U, 3U})
    bench.state.Receive(ToConsole(SnapshotOf(number), 0.0));
  CHECK(bench.Answers() ==
        Answers{console::ANSWER_OUTDATED, console::ANSWER_PATH, console::ANSWER_NONE});
}

TEST_CASE("a robot that counts its pictures anew has none answered", "[operator][console]") {
  StateBench bench;
  bench.state.Receive(Answering(2));
  bench.state.Receive(At(1, {1, 1}), 0.0);
  bench.state.Receive(ToConsole(SnapshotOf(1), 0.0));
  CHECK(bench.Answers() == Answers{console::ANSWER_NONE});
}

TEST_CASE("the newest pictures and events are kept", "[operator][console]") {
  StateBench bench;
  for (std::uint64_t i = 1; i <= ConsoleState::kSnapshotsKept + 5; ++i) {
    bench.state.Receive(ToConsole(SnapshotOf(i), 0.0));
  }
  const auto pictures = AllOf(bench.log, Kind::kPicture);
  CHECK(pictures.size() == ConsoleState::kSnapshotsKept);
  CHECK(pictures.front().picture().sequence_number() == 6);
  for (std::size_t i = 0; i < ConsoleState::kEventsKept + 3; ++i) {
    bench.state.Receive(console::Event());
  }
  const auto events = AllOf(bench.log, Kind::kEvent);
  CHECK(events.size() == ConsoleState::kEventsKept);
  CHECK(events.front().event().id() == 4);
}

TEST_CASE("the newest picture can be heard again, with its answer", "[operator][console]") {
  StateBench bench;
  bench.state.ReceiveSnapshotAgain("r1", 5.0);
  CHECK(AllOf(bench.log, Kind::kPicture).empty());
  bench.state.Receive(ToConsole(SnapshotOf(1), 10.0));
  bench.state.Receive(ToConsole(SnapshotOf(2), 11.0));
  bench.state.ReceiveSnapshotAgain("r1", 20.0);
  bench.state.ReceiveAnswer("r1", 2, "anna");
  const auto pictures = AllOf(bench.log, Kind::kPicture);
  REQUIRE(pictures.size() == 2);
  CHECK(pictures[0].picture().heard_at() == 10.0);
  CHECK(pictures[1].picture().heard_at() == 20.0);
  bench.state.ReceiveSnapshotAgain("r1", 30.0);
  const auto again = AllOf(bench.log, Kind::kPicture).back().picture();
  CHECK(again.heard_at() == 30.0);
  CHECK(again.answer() == console::ANSWER_NOTHING_NEW);
}

}  // namespace conav::operators
