#include "operator/supervision/attention_queue.h"

#include <catch2/catch.hpp>
#include <cmath>

#include "unit/operator/supervision/attention_samples.h"

namespace conav::operators {
namespace {

using Robots = std::vector<std::string>;

constexpr InteractionPriors kPriors{.picture_s = 8.0, .log_sd = 0.5, .weight = 3.0};

TEST_CASE("A robot with goals and without a path ever is in the queue until it is guided",
          "[operator][attention]") {
  AttentionQueue queue({});
  queue.Receive(WorkingRobot("r1"), At(1));
  queue.Receive(WorkingRobot("r1"), At(2));
  queue.Update(InteractionTimes({}), At(2));
  REQUIRE(queue.items().size() == 1);
  CHECK(queue.items()[0].reason == AttentionReason::kFirstPath);
  CHECK(queue.items()[0].since == At(1));
  CHECK(queue.TakeArrivals().size() == 1);
  queue.Receive(PathFor("r1"), At(3));
  CHECK(queue.items().empty());
  const auto departures = queue.TakeDepartures();
  REQUIRE(departures.size() == 1);
  CHECK(departures[0].answered);
  CHECK(departures[0].at == At(3));
}

TEST_CASE("A robot whose goals nobody has found yet is at work, and not done after the first one",
          "[operator][attention]") {
  AttentionQueue queue({});
  RobotState state = WorkingRobot("r1");
  state.goals_stamp = {};
  state.goals_left = state.goals_reached = {};
  state.goals_total = 2;
  queue.Receive(state, At(1));
  REQUIRE(queue.items().size() == 1);
  CHECK(queue.items()[0].reason == AttentionReason::kFirstPath);
  queue.Receive(PathFor("r1"), At(2));
  state.goals_reached = {{1, 1}};
  queue.Receive(state, At(3));
  CHECK(queue.items().empty());
  state.goals_reached.push_back({2, 2});
  queue.Receive(state, At(4));
  REQUIRE(queue.items().size() == 1);
  CHECK(queue.items()[0].reason == AttentionReason::kGoalsReached);
}

TEST_CASE("Within a tier value lost per second over expected interaction time decides",
          "[operator][attention]") {
  QueueBench bench;
  bench.queue.Receive(Question("r1", AttentionReason::kBlocked, 2.0), At(1));
  bench.queue.Receive(Question("r2", AttentionReason::kBlocked, 8.0), At(1));
  bench.queue.Receive(Question("r3", AttentionReason::kSnapshot, 99.0), At(1));
  CHECK(bench.Order(1) == Robots{"r2", "r1", "r3"});
  const double expected = bench.times.Expected(AttentionReason::kBlocked);
  CHECK(bench.queue.items()[0].expected_interaction_s == expected);
  CHECK(bench.queue.items()[0].score == 8.0 / expected);
}

TEST_CASE("Asking again, and who asks next", "[operator][attention]") {
  QueueBench bench;
  SECTION("Asked again a robot keeps its place in time and takes the newer numbers") {
    bench.queue.Receive(Question("r1", AttentionReason::kBlocked, 1.0, 1), At(1));
    bench.queue.Receive(Question("r1", AttentionReason::kBlocked, 3.0, 2), At(5));
    bench.Order(5);
    REQUIRE(bench.queue.items().size() == 1);
    CHECK(bench.queue.items()[0].since == At(1));
    CHECK(bench.queue.items()[0].value_lost_per_s == 3.0);
    CHECK(bench.queue.items()[0].source_sequence == 2);
    CHECK(bench.queue.TakeArrivals().size() == 1);
  }
  SECTION("A higher tier takes the first place at once") {
    bench.queue.Receive(Question("r1", AttentionReason::kSnapshot, 9.0), At(0));
    bench.Order(0);
    bench.queue.Receive(Question("r2", AttentionReason::kBlocked, 0.1), At(1));
    CHECK(bench.Order(1) == Robots{"r2", "r1"});
  }
  SECTION("A selection names who works on it, another client or a wrong item is refused") {
    bench.queue.Receive(Question("r1", AttentionReason::kBlocked, 1.0), At(1));
    bench.queue.Receive(Question("r2", AttentionReason::kBlocked, 1.0), At(1));
    CHECK(bench.queue.robots_waiting() == 2);
    REQUIRE(bench.queue.Select("anna", {"r1", AttentionReason::kBlocked}, At(2)));
    CHECK(bench.queue.robots_waiting() == 1);
    const auto taken = bench.queue.Select("bert", {"r1", AttentionReason::kBlocked}, At(2));
    REQUIRE_FALSE(taken);
    CHECK_THAT(taken.error().text, Catch::Contains("anna") && Catch::Contains("r1"));
    CHECK_FALSE(bench.queue.Select("bert", {"r3", AttentionReason::kBlocked}, At(2)));
    REQUIRE(bench.queue.Select("anna", {"r2", AttentionReason::kBlocked}, At(3)));
    CHECK(bench.queue.Select("bert", {"r1", AttentionReason::kBlocked}, At(3)));
  }
  SECTION("A robot without goals asks for nothing, that is shown until it is selected") {
    bench.queue.Receive(Question("r1", AttentionReason::kBlocked, 1.0), At(1));
    RobotState done = WorkingRobot("r1");
    done.goals_left.clear();
    bench.queue.Receive(done, At(2));
    bench.queue.Receive(done, At(3));
    CHECK(bench.Order(3) == Robots{"r1"});
    CHECK(bench.queue.items()[0].reason == AttentionReason::kGoalsReached);
    REQUIRE(bench.queue.Select("anna", {"r1", AttentionReason::kGoalsReached}, At(4)));
    CHECK(bench.Order(4).empty());
    bench.queue.Receive(done, At(5));
    CHECK(bench.Order(5).empty());
  }
}

TEST_CASE(
    "The first item stays against a slightly better one for a while, not against a clearly better "
    "one",
    "[operator][attention]") {
  QueueBench bench({.hysteresis_factor = 1.5, .dwell_s = 10.0});
  bench.queue.Receive(Question("r1", AttentionReason::kBlocked, 2.0), At(0));
  CHECK(bench.Order(0) == Robots{"r1"});
  bench.queue.Receive(Question("r2", AttentionReason::kBlocked, 2.9), At(1));
  CHECK(bench.Order(1) == Robots{"r1", "r2"});
  bench.queue.Receive(Question("r3", AttentionReason::kBlocked, 3.0), At(2));
  CHECK(bench.Order(2) == Robots{"r3", "r2", "r1"});  // 1.5 times as much
  QueueBench later({.dwell_s = 10.0});
  later.queue.Receive(Question("r1", AttentionReason::kBlocked, 2.0), At(0));
  later.Order(0);
  later.queue.Receive(Question("r2", AttentionReason::kBlocked, 2.1), At(1));
  CHECK(later.Order(9.9) == Robots{"r1", "r2"});
  CHECK(later.Order(10) == Robots{"r2", "r1"});
  later.queue.Receive(Question("r1", AttentionReason::kBlocked, 2.2, 2), At(11));
  CHECK(later.Order(11) == Robots{"r2", "r1"});  // no flapping
}

TEST_CASE("Guidance answers what it was drawn for", "[operator][attention]") {
  QueueBench bench;
  SECTION("A picture is answered by guidance for it, not by guidance for an older one") {
    AttentionRequest request = Question("r1", AttentionReason::kSnapshot, 1.0);
    request.newest_snapshot = 4;  // the one asked about will be 5
    bench.queue.Receive(request, At(1));
    bench.queue.Receive(PathFor("r1", 4), At(2));
    CHECK(bench.Order(2) == Robots{"r1"});
    CHECK(bench.queue.items()[0].newest_snapshot == 5);
    bench.queue.Receive(PathFor("r1", 5), At(3));
    CHECK(bench.Order(3).empty());
  }
  SECTION("A withdrawn path answers nothing unless it answers a picture") {
    bench.queue.Receive(Question("r1", AttentionReason::kBlocked, 1.0), At(1));
    Guidance withdrawn = PathFor("r1");
    withdrawn.path.clear();
    bench.queue.Receive(withdrawn, At(2));
    CHECK(bench.Order(2) == Robots{"r1"});
    withdrawn.answers_snapshot = 1;
    bench.queue.Receive(withdrawn, At(2));
    CHECK(bench.Order(2).empty());

    bench.queue.Receive(Question("r1", AttentionReason::kBlocked, 1.0), At(3));
    bench.queue.Receive(withdrawn, At(4));  // names the picture that was answered before
    CHECK(bench.Order(4) == Robots{"r1"});
  }
  SECTION("A robot that restarts its count of pictures needs new answers") {
    bench.queue.Receive(PathFor("r1", 9), At(1));
    Guidance guidance = PathFor("r1", 0);
    guidance.path.clear();
    bench.queue.Receive(guidance, At(2));  // withdrawn: the simulator was started again
    bench.queue.Receive(Question("r1", AttentionReason::kSnapshot, 1.0), At(3));
    guidance.answers_snapshot = 1;  // nothing new
    bench.queue.Receive(guidance, At(4));
    CHECK(bench.Order(4).empty());
  }
}

TEST_CASE("A question about a picture that is asked again comes in once, until it is answered",
          "[operator][attention]") {
  QueueBench bench;
  AttentionRequest request = Question("r1", AttentionReason::kSnapshot, 1.0);
  request.newest_snapshot = 4;
  bench.queue.Receive(request, At(1));
  CHECK(bench.Order(1) == Robots{"r1"});
  const AttentionItem before = bench.queue.items()[0];
  request.sequence_number = 2;
  request.stamp = At(11);
  bench.queue.Receive(request, At(11));
  CHECK(bench.Order(11) == Robots{"r1"});
  CHECK(bench.queue.items()[0].source_sequence == before.source_sequence);
  CHECK(bench.queue.TakeArrivals().size() == 1);

  bench.queue.LosePlanner("r1", At(12));
  request.sequence_number = 3;
  bench.queue.Receive(request, At(13));
  CHECK(bench.Order(13) == Robots{"r1"});
  bench.queue.Receive(PathFor("r1", 5), At(14));
  bench.queue.Receive(request, At(14));  // sent before the answer came
  CHECK(bench.Order(14).empty());
}

TEST_CASE("Questions leave when they are withdrawn or their time is over",
          "[operator][attention]") {
  QueueBench bench;
  SECTION("A robot that no longer asks, or whose planner is gone, leaves unanswered") {
    bench.queue.Receive(Question("r1", AttentionReason::kBlocked, 1.0, 3), At(1));
    bench.queue.Receive(Question("r2", AttentionReason::kSnapshot, 1.0), At(1));
    bench.queue.Receive(Question("r1", AttentionReason::kNone, 0.0, 2),
                        At(2));  // of the one before
    CHECK(bench.Order(2) == Robots{"r1", "r2"});
    bench.queue.Receive(Question("r1", AttentionReason::kNone, 0.0, 3), At(2));
    CHECK(bench.Order(2) == Robots{"r2"});
    bench.queue.LosePlanner("r2", At(3));
    CHECK(bench.Order(3).empty());
    for (const auto& departure : bench.queue.TakeDepartures()) CHECK_FALSE(departure.answered);
  }
  SECTION("A question that was never withdrawn leaves a while after its deadline") {
    AttentionRequest request = Question("r1", AttentionReason::kSnapshot, 1.0);
    request.stamp = At(101);  // its world's clock
    request.gives_up_at = At(120);
    bench.queue.Receive(request, At(1));
    CHECK(bench.Order(30) == Robots{"r1"});
    CHECK(bench.queue.items()[0].deadline == At(20));
    CHECK(bench.Order(30.1).empty());
  }
  SECTION("A robot that waits by the wall clock has no deadline in the operator's time") {
    AttentionRequest request = Question("r1", AttentionReason::kSnapshot, 1.0);
    request.gives_up_after_s = 10.0;
    bench.queue.Receive(request, At(1));
    CHECK(bench.Order(1000) == Robots{"r1"});  // simulation time may go by more quickly
    CHECK(bench.queue.items()[0].deadline == SimTime{});
    CHECK(bench.queue.items()[0].gives_up_after_s == 10.0);
  }
}

TEST_CASE("A robot that is driven needs no first path any more", "[operator][attention]") {
  AttentionQueue queue({});
  RobotState state = WorkingRobot("r1");
  queue.Receive(state, At(1));
  CHECK(queue.items().size() == 1);
  for (const std::uint64_t order : {1, 2}) {
    state.drive_order = order;
    queue.Receive(state, At(2));
    CHECK(queue.items().empty());
  }
  CHECK(queue.TakeDepartures().at(0).answered);
}

TEST_CASE("A lost link replaces what the robot asked by a notice that ends",
          "[operator][attention]") {
  QueueBench bench({.notice_s = 60.0});
  bench.queue.Receive(Question("r1", AttentionReason::kBlocked, 1.0), At(1));
  bench.queue.LoseLink("r1", At(2));
  bench.queue.LoseLink("r1", At(3));
  CHECK(bench.Order(3) == Robots{"r1"});
  CHECK(bench.queue.items()[0].reason == AttentionReason::kLinkLost);
  CHECK(bench.queue.items()[0].since == At(2));
  CHECK(bench.queue.robots_at_work() == 2);
  bench.queue.Receive(Question("r1", AttentionReason::kBlocked, 1.0, 2), At(4));  // late
  CHECK(bench.Order(61.9).size() == 1);
  CHECK(bench.Order(62).empty());
}

TEST_CASE("A link that is back takes its notice away, a failed command is shown until the next",
          "[operator][attention]") {
  QueueBench bench;
  bench.queue.LoseLink("r1", At(2));
  bench.queue.Receive(WorkingRobot("r1"), At(3));
  CHECK(bench.Order(3).empty());
  CHECK(bench.queue.robots_at_work() == 3);
  bench.queue.Receive(WorkingRobot("r1", CommandOutcome::kExpired), At(1));
  bench.queue.Receive(WorkingRobot("r1", CommandOutcome::kExpired), At(2));
  CHECK(bench.Order(2) == Robots{"r1"});
  CHECK(bench.queue.items()[0].tier == 1);
  bench.queue.Receive(WorkingRobot("r1", CommandOutcome::kRunning), At(3));
  CHECK(bench.Order(3).empty());
}

TEST_CASE("Tiers: stopped, link lost, asking, picture, information", "[operator][attention]") {
  using enum AttentionReason;
  for (const auto& [reason, tier] : {std::pair(kCommandFailed, 1),
                                     {kLinkLost, 2},
                                     {kBlocked, 3},
                                     {kNoGuidance, 3},
                                     {kFirstPath, 3},
                                     {kSnapshot, 4},
                                     {kGoalsReached, 5}}) {
    CAPTURE(static_cast<int>(reason));
    CHECK(TierOf(reason) == tier);
  }
  CHECK(IsQuestion(kSnapshot));
  CHECK_FALSE(IsQuestion(kLinkLost));
}

TEST_CASE("Of equal scores the older comes first, FIFO: age alone", "[operator][attention]") {
  QueueBench equal;
  equal.queue.Receive(Question("r2", AttentionReason::kBlocked, 1.0), At(1));
  equal.queue.Receive(Question("r1", AttentionReason::kBlocked, 1.0), At(2));
  CHECK(equal.Order(2) == Robots{"r2", "r1"});
  QueueBench fifo({.order = "fifo"});
  fifo.queue.Receive(Question("r1", AttentionReason::kSnapshot, 1.0), At(1));
  fifo.queue.Receive(Question("r2", AttentionReason::kBlocked, 9.0), At(2));
  CHECK(fifo.Order(2) == Robots{"r1", "r2"});
}

TEST_CASE("Nearest deadline: stated, assumed for questions that wait, none for notices",
          "[operator][attention]") {
  QueueBench bench({.order = "nearest_deadline", .default_deadline_s = 100.0});
  RobotState done = WorkingRobot("r3");
  done.goals_left.clear();
  bench.queue.Receive(done, At(0));
  bench.queue.Receive(Question("r2", AttentionReason::kBlocked, 1.0), At(1));  // 101
  AttentionRequest stated = Question("r1", AttentionReason::kSnapshot, 1.0);
  AttentionRequest by_wall_clock = stated;
  const bool later = GENERATE(false, true);
  stated.stamp = At(30);
  stated.gives_up_at = At(later ? 102 : 100);
  bench.queue.Receive(stated, At(30));
  CHECK(bench.Order(30) == (later ? Robots{"r2", "r1", "r3"} : Robots{"r1", "r2", "r3"}));
  by_wall_clock.gives_up_after_s = later ? 72.0 : 70.0;
  bench.queue.Receive(by_wall_clock, At(31));  // since 30
  CHECK(bench.Order(31) == (later ? Robots{"r2", "r1", "r3"} : Robots{"r1", "r2", "r3"}));
}

TEST_CASE(
    "Interaction times begin with the prior and move with the history of their reason, by hand",
    "[operator][attention]") {
  const InteractionTimes prior(kPriors);
  CHECK(prior.Expected(AttentionReason::kSnapshot) == Approx(8.0 * std::exp(0.125)));
  CHECK(prior.Expected(AttentionReason::kBlocked) == Approx(10.0 * std::exp(0.125)));
  InteractionTimes times(kPriors);
  times.Add(AttentionReason::kSnapshot, 2.0);
  // m = (3 log 8 + log 2) / 4 = 2.5 log 2; E log^2 = (3 (0.25 + 9 log^2 2) + log^2 2) / 4
  const double log2 = std::log(2.0);
  const double variance = (0.75 + 28.0 * log2 * log2) / 4.0 - 6.25 * log2 * log2;
  CHECK(times.Expected(AttentionReason::kSnapshot) ==
        Approx(std::exp(2.5 * log2 + variance / 2.0)));
  CHECK(times.Expected(AttentionReason::kBlocked) == Approx(10.0 * std::exp(0.125)));
  InteractionTimes longest(kPriors);
  for (int i = 0; i < 3000; ++i) longest.Add(AttentionReason::kSnapshot, 20.0);
  CHECK(longest.Expected(AttentionReason::kSnapshot) == Approx(20.0).epsilon(0.01));
}

TEST_CASE("A replaced interaction counts once, and no time is below a millisecond",
          "[operator][attention]") {
  InteractionTimes replaced(kPriors);
  replaced.Add(AttentionReason::kBlocked, 3.0);
  replaced.Replace(AttentionReason::kBlocked, 3.0, 6.0);
  InteractionTimes added(kPriors);
  added.Add(AttentionReason::kBlocked, 6.0);
  CHECK(replaced.Expected(AttentionReason::kBlocked) ==
        Approx(added.Expected(AttentionReason::kBlocked)));
  added.Add(AttentionReason::kBlocked, 0.0);
  CHECK(std::isfinite(added.Expected(AttentionReason::kBlocked)));
}

}  // namespace
}  // namespace conav::operators
