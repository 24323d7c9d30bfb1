#include <catch2/catch.hpp>

#include "unit/operator/support/synthetic_fixture.h"

namespace conav::operators {
namespace {

SyntheticOperatorParameters FollowingTheQueue() {
  SyntheticOperatorParameters parameters = Flawless();
  parameters.order = "queue";
  parameters.interaction = {.picture_s = 4.0, .blocked_s = 8.0, .path_s = 12.0, .log_sd = 0.0};
  return parameters;
}

AttentionItem Line(const std::string& robot, AttentionReason reason,
                   std::uint64_t newest_snapshot = 0) {
  AttentionItem item;
  item.world = "w1";
  item.robot = robot;
  item.reason = reason;
  item.newest_snapshot = newest_snapshot;
  return item;
}

AttentionQueueState Queue(std::uint64_t revision, std::vector<AttentionItem> items) {
  return {{0}, revision, "priority", std::move(items), {}};
}

/// Two robots that both have a first path to wait for.
struct QueueFixture : Desk {
  QueueFixture() : Desk(FollowingTheQueue(), {{"r1", "w1"}, {"r2", "w1"}}) {
    person.Receive(MapAt(0));
    person.Receive(StateAt({1, 1}, 10, "r1"));
    person.Receive(StateAt({3, 1}, 10, "r2"));
    person.Receive(SimTime::FromSeconds(100));
  }
  SelectRequest ExpectSelect() {
    const auto ask = person.Next(clock.Now());
    REQUIRE(ask.has_value());
    REQUIRE(std::holds_alternative<SelectRequest>(ask->body));
    return std::get<SelectRequest>(ask->body);
  }
};

TEST_CASE("Without a published queue nothing is taken up", "[operator][simulated]") {
  QueueFixture desk;
  desk.ExpectNothing();
}

TEST_CASE("The first of the queue is selected, then answered after its interaction time",
          "[operator][simulated]") {
  QueueFixture desk;
  desk.person.Receive(
      Queue(1, {Line("r2", AttentionReason::kFirstPath), Line("r1", AttentionReason::kFirstPath)}));
  CHECK(desk.ExpectSelect() == SelectRequest{"r2", AttentionReason::kFirstPath});
  desk.ExpectNothing();
  desk.Accept(0);
  desk.person.Receive(SimTime::FromSeconds(111.9));
  desk.ExpectNothing();
  desk.person.Receive(SimTime::FromSeconds(112));
  CHECK(desk.ExpectGuide().robot == "r2");
  desk.Accept(1);
  CHECK(desk.ExpectSelect() == SelectRequest{"r1", AttentionReason::kFirstPath});
}

TEST_CASE("What the person cannot deal with yet, or somebody else works on, is passed over",
          "[operator][simulated]") {
  QueueFixture desk;
  AttentionItem taken = Line("r2", AttentionReason::kFirstPath);
  taken.selected_by = "bert";
  desk.person.Receive(Queue(1, {Line("r1", AttentionReason::kPicture, 1), taken,
                                Line("r1", AttentionReason::kFirstPath)}));
  CHECK(desk.ExpectSelect() == SelectRequest{"r1", AttentionReason::kFirstPath});
}

TEST_CASE("A refused selection is given up until the queue has changed", "[operator][simulated]") {
  QueueFixture desk;
  desk.person.Receive(Queue(1, {Line("r1", AttentionReason::kFirstPath)}));
  desk.ExpectSelect();
  desk.Refuse(0);
  desk.ExpectNothing();
  CHECK(desk.person.open() == 2);
  desk.person.Receive(Queue(2, {Line("r2", AttentionReason::kFirstPath)}));
  CHECK(desk.ExpectSelect() == SelectRequest{"r2", AttentionReason::kFirstPath});
}

TEST_CASE("A blocked robot is answered with what its newest streamed picture shows besides",
          "[operator][simulated]") {
  QueueFixture desk;
  desk.person.Receive(SnapshotOf(1, 11, true), desk.clock.Now());
  desk.person.Receive(Queue(1, {}));
  desk.ExpectNothing();  // a stream is looked at while its robot is attended to
  desk.person.Receive(Attention(AttentionReason::kBlocked, {2, 1}, 1, 10), desk.clock.Now());
  desk.person.Receive(Queue(2, {Line("r1", AttentionReason::kBlocked)}));
  CHECK(desk.ExpectSelect() == SelectRequest{"r1", AttentionReason::kBlocked});
  desk.Accept(0);
  desk.person.Receive(SimTime::FromSeconds(108));
  CHECK(desk.ExpectEdit().edits == std::vector<CellEdit>{{{2, 1}, true}, {{1, 3}, true}});
}

TEST_CASE("A question that the robot takes back is not answered", "[operator][simulated]") {
  QueueFixture desk;
  desk.person.Receive(Attention(AttentionReason::kBlocked, {1, 2}, 0, 10, 1), desk.clock.Now());
  desk.person.Receive(Attention(AttentionReason::kNone, {1, 1}, 0, 12, 1), desk.clock.Now());
  desk.person.Receive(Queue(1, {Line("r1", AttentionReason::kBlocked)}));
  desk.ExpectNothing();
}

TEST_CASE("Log-normal interaction times have the mean that was given", "[operator][simulated]") {
  SyntheticOperatorParameters parameters = FollowingTheQueue();
  parameters.interaction.log_sd = 0.5;
  Desk desk(parameters);
  desk.person.Receive(MapAt(0));
  desk.person.Receive(StateAt({1, 1}, 10));
  double now_s = 100.0;
  desk.person.Receive(SimTime::FromSeconds(now_s));
  constexpr int kMatters = 2000;
  double total_s = 0.0;
  for (int i = 1; i <= kMatters; ++i) {
    const auto number = static_cast<std::uint64_t>(i);
    desk.person.Receive(Attention(AttentionReason::kNoGuidance, {1, 1}, 0, 10, number),
                        desk.clock.Now());
    desk.person.Receive(Queue(number, {Line("r1", AttentionReason::kNoGuidance)}));
    REQUIRE(desk.person.Next(desk.clock.Now()));
    desk.Accept(0);
    const double start_s = now_s;
    std::optional<OperatorAsk> ask;
    while (!(ask = desk.person.Next(desk.clock.Now()))) {
      now_s += 0.1;
      desk.person.Receive(SimTime::FromSeconds(now_s));
    }
    desk.Accept(1);
    total_s += now_s - start_s;
  }
  CHECK(total_s / kMatters == Approx(12.05).margin(0.5));  // 6 / sqrt(2000) = 0.14 s of error
}

}  // namespace
}  // namespace conav::operators
