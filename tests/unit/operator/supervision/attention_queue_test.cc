#include "operator/supervision/attention_queue.h"

#include <catch2/catch.hpp>

#include "unit/operator/supervision/attention_samples.h"

namespace conav::operators {
namespace {

using Robots = std::vector<std::string>;

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

TEST_CASE("Within a tier value lost per second over expected interaction time decides",
          "[operator][attention]") {
  QueueBench bench;
  bench.queue.Receive(Question("r1", AttentionReason::kBlocked, 2.0), At(1));
  bench.queue.Receive(Question("r2", AttentionReason::kBlocked, 8.0), At(1));
  bench.queue.Receive(Question("r3", AttentionReason::kPicture, 99.0), At(1));
  CHECK(bench.Order(1) == Robots{"r2", "r1", "r3"});
  const double expected = bench.times.Expected(AttentionReason::kBlocked);
  CHECK(bench.queue.items()[0].expected_interaction_s == expected);
  CHECK(bench.queue.items()[0].score == 8.0 / expected);
}

TEST_CASE("Asked again a robot keeps its place in time and takes the newer numbers",
          "[operator][attention]") {
  QueueBench bench;
  bench.queue.Receive(Question("r1", AttentionReason::kBlocked, 1.0, 1), At(1));
  bench.queue.Receive(Question("r1", AttentionReason::kBlocked, 3.0, 2), At(5));
  bench.Order(5);
  REQUIRE(bench.queue.items().size() == 1);
  CHECK(bench.queue.items()[0].since == At(1));
  CHECK(bench.queue.items()[0].value_lost_per_s == 3.0);
  CHECK(bench.queue.items()[0].source_sequence == 2);
  CHECK(bench.queue.TakeArrivals().size() == 1);
}

TEST_CASE("A slightly better newcomer does not take the first place, a clearly better one does",
          "[operator][attention]") {
  AttentionOptions options;
  options.hysteresis_factor = 1.5;
  options.dwell_s = 10.0;
  QueueBench bench(options);
  bench.queue.Receive(Question("r1", AttentionReason::kBlocked, 2.0), At(0));
  CHECK(bench.Order(0) == Robots{"r1"});
  bench.queue.Receive(Question("r2", AttentionReason::kBlocked, 2.9), At(1));
  CHECK(bench.Order(1) == Robots{"r1", "r2"});
  bench.queue.Receive(Question("r3", AttentionReason::kBlocked, 3.0), At(2));
  CHECK(bench.Order(2) == Robots{"r3", "r2", "r1"});  // 1.5 times as much
}

TEST_CASE("After it has dwelt at the top the first item gives way to a slightly better one",
          "[operator][attention]") {
  AttentionOptions options;
  options.dwell_s = 10.0;
  QueueBench bench(options);
  bench.queue.Receive(Question("r1", AttentionReason::kBlocked, 2.0), At(0));
  bench.Order(0);
  bench.queue.Receive(Question("r2", AttentionReason::kBlocked, 2.1), At(1));
  CHECK(bench.Order(9.9) == Robots{"r1", "r2"});
  CHECK(bench.Order(10) == Robots{"r2", "r1"});
  bench.queue.Receive(Question("r1", AttentionReason::kBlocked, 2.2, 2), At(11));
  CHECK(bench.Order(11) == Robots{"r2", "r1"});  // no flapping
}

TEST_CASE("A higher tier takes the first place at once", "[operator][attention]") {
  QueueBench bench;
  bench.queue.Receive(Question("r1", AttentionReason::kPicture, 9.0), At(0));
  bench.Order(0);
  bench.queue.Receive(Question("r2", AttentionReason::kBlocked, 0.1), At(1));
  CHECK(bench.Order(1) == Robots{"r2", "r1"});
}

TEST_CASE("A picture is answered by guidance for it, not by guidance for an older one",
          "[operator][attention]") {
  QueueBench bench;
  AttentionRequest request = Question("r1", AttentionReason::kPicture, 1.0);
  request.newest_snapshot = 4;  // the one asked about will be 5
  bench.queue.Receive(request, At(1));
  bench.queue.Receive(PathFor("r1", 4), At(2));
  CHECK(bench.Order(2) == Robots{"r1"});
  CHECK(bench.queue.items()[0].newest_snapshot == 5);
  bench.queue.Receive(PathFor("r1", 5), At(3));
  CHECK(bench.Order(3).empty());
}

TEST_CASE("A withdrawn path answers nothing unless it answers a picture", "[operator][attention]") {
  QueueBench bench;
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

TEST_CASE("A robot that counts its pictures anew is answered anew", "[operator][attention]") {
  QueueBench bench;
  bench.queue.Receive(PathFor("r1", 9), At(1));
  Guidance guidance = PathFor("r1", 0);
  guidance.path.clear();
  bench.queue.Receive(guidance, At(2));  // withdrawn: the simulator was started again
  bench.queue.Receive(Question("r1", AttentionReason::kPicture, 1.0), At(3));
  guidance.answers_snapshot = 1;  // nothing new
  bench.queue.Receive(guidance, At(4));
  CHECK(bench.Order(4).empty());
}

TEST_CASE("A robot that asks no more, or whose planner is gone, leaves unanswered",
          "[operator][attention]") {
  QueueBench bench;
  bench.queue.Receive(Question("r1", AttentionReason::kBlocked, 1.0, 3), At(1));
  bench.queue.Receive(Question("r2", AttentionReason::kPicture, 1.0), At(1));
  bench.queue.Receive(Question("r1", AttentionReason::kNone, 0.0, 2), At(2));  // of the one before
  CHECK(bench.Order(2) == Robots{"r1", "r2"});
  bench.queue.Receive(Question("r1", AttentionReason::kNone, 0.0, 3), At(2));
  CHECK(bench.Order(2) == Robots{"r2"});
  bench.queue.LosePlanner("r2", At(3));
  CHECK(bench.Order(3).empty());
  for (const auto& departure : bench.queue.TakeDepartures()) CHECK_FALSE(departure.answered);
}

TEST_CASE("What a robot never withdrew leaves a while after its deadline",
          "[operator][attention]") {
  QueueBench bench;
  AttentionRequest request = Question("r1", AttentionReason::kPicture, 1.0);
  request.stamp = At(101);  // its world's clock
  request.gives_up_at = At(120);
  bench.queue.Receive(request, At(1));
  CHECK(bench.Order(30) == Robots{"r1"});
  CHECK(bench.queue.items()[0].deadline == At(20));
  CHECK(bench.Order(30.1).empty());
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

TEST_CASE("A robot that waits by the wall clock has no deadline in the operator's time",
          "[operator][attention]") {
  QueueBench bench;
  AttentionRequest request = Question("r1", AttentionReason::kPicture, 1.0);
  request.gives_up_after_s = 10.0;
  bench.queue.Receive(request, At(1));
  CHECK(bench.Order(1000) == Robots{"r1"});  // simulation time may go by more quickly
  CHECK(bench.queue.items()[0].deadline == SimTime{});
  CHECK(bench.queue.items()[0].gives_up_after_s == 10.0);
}

TEST_CASE("A lost link replaces what the robot asked by a notice that ends",
          "[operator][attention]") {
  AttentionOptions options;
  options.notice_s = 60.0;
  QueueBench bench(options);
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

TEST_CASE("A link that is back takes its notice away", "[operator][attention]") {
  QueueBench bench;
  bench.queue.LoseLink("r1", At(2));
  bench.queue.Receive(WorkingRobot("r1"), At(3));
  CHECK(bench.Order(3).empty());
  CHECK(bench.queue.robots_at_work() == 3);
}

TEST_CASE("A failed command is shown until the next one is taken up", "[operator][attention]") {
  QueueBench bench;
  bench.queue.Receive(WorkingRobot("r1", CommandOutcome::kExpired), At(1));
  bench.queue.Receive(WorkingRobot("r1", CommandOutcome::kExpired), At(2));
  CHECK(bench.Order(2) == Robots{"r1"});
  CHECK(bench.queue.items()[0].tier == 1);
  bench.queue.Receive(WorkingRobot("r1", CommandOutcome::kRunning), At(3));
  CHECK(bench.Order(3).empty());
}

TEST_CASE("A robot without goals asks for nothing, that is shown until it is selected",
          "[operator][attention]") {
  QueueBench bench;
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

TEST_CASE("A selection names who works on it, another client or a wrong item is refused",
          "[operator][attention]") {
  QueueBench bench;
  bench.queue.Receive(Question("r1", AttentionReason::kBlocked, 1.0), At(1));
  bench.queue.Receive(Question("r2", AttentionReason::kBlocked, 1.0), At(1));
  CHECK(bench.queue.robots_waiting() == 2);
  REQUIRE(bench.queue.Select("anna", {"r1", AttentionReason::kBlocked}, At(2)));
  CHECK(bench.queue.robots_waiting() == 1);
  const auto taken = bench.queue.Select("bert", {"r1", AttentionReason::kBlocked}, At(2));
  REQUIRE_FALSE(taken);
  CHECK(taken.error().text == "anna already works on the request of robot 'r1'");
  CHECK_FALSE(bench.queue.Select("bert", {"r3", AttentionReason::kBlocked}, At(2)));
  REQUIRE(bench.queue.Select("anna", {"r2", AttentionReason::kBlocked}, At(3)));
  CHECK(bench.queue.Select("bert", {"r1", AttentionReason::kBlocked}, At(3)));
}

}  // namespace
}  // namespace conav::operators
