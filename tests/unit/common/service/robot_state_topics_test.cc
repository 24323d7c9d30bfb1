#include "common/service/robot_state_topics.h"

#include <catch2/catch.hpp>

#include "common/bus/in_memory_bus.h"
#include "unit/common/msg/samples.h"

namespace conav {
namespace {

using namespace std::chrono_literals;

/// A robot, and an operator's side that reads its states.
struct StateBench {
  explicit StateBench(bool over_link = true) {
    if (over_link) bus->SetOverLink();
    reader.emplace("reader", bus);
    topics.emplace(*reader, "r1", RobotStateTopics::Rate::kThrottledOverLinks);
    goals.emplace(*reader, bus::kRobotGoals, "r1");
    robot.emplace("robot", bus);
    publisher.emplace(*robot, "r1");
    topics->TakeStamped();  // finds the robot
  }
  /// The states that arrive after one that was given.
  std::vector<bus::Stamped<RobotState>> Give() {
    RobotGoals own = GoalsOf(state, 0.5);
    own.stamp = state.goals_stamp;
    REQUIRE(goals->Publish(ToMessage(own)));
    topics->TakeStamped();  // the state before, with these goals
    publisher->Publish(state, clock.Now());
    return topics->TakeStamped();
  }

  std::shared_ptr<bus::InMemoryBus> bus = std::make_shared<bus::InMemoryBus>();
  FakeClock clock;
  std::optional<bus::Participant> reader;
  std::optional<RobotStateTopics> topics;
  std::optional<bus::Participant> robot;
  std::optional<RobotStatePublisher> publisher;
  std::optional<bus::Publisher<conav_msgs::msg::RobotGoals>> goals;
  RobotState state = samples::SampleState();
};

TEST_CASE("over a link the state of a robot that only moves comes every 0.5 s of its time",
          "[service]") {
  StateBench bench;
  CHECK(bench.Give().size() == 1);
  for (const std::size_t sent : {0U, 1U, 0U, 1U}) {
    bench.state.stamp = bench.state.stamp + 250ms;
    bench.state.position.x_m += 0.1;
    ++bench.state.command_sequence_number;
    CHECK(bench.Give().size() == sent);
  }
  bench.clock.Advance(1s);  // its time stands still
  CHECK(bench.Give().size() == 1);
  bench.state.stamp = {};  // it has begun again
  CHECK(bench.Give().size() == 1);
}

TEST_CASE("on one machine no state is left out", "[service]") {
  StateBench bench(false);
  for (int i = 0; i < 3; ++i) {
    bench.state.stamp = bench.state.stamp + 1ms;
    CHECK(bench.Give().size() == 1);
  }
}

TEST_CASE("what an operator waits for comes over a link at once", "[service]") {
  using Change = void (*)(RobotState&);
  const Change change =
      GENERATE(Change([](RobotState& s) { s.command_outcome = CommandOutcome::kRefused; }),
               Change([](RobotState& s) { s.stopped = false; }),
               Change([](RobotState& s) { ++s.stop_revision; }),
               Change([](RobotState& s) { s.goals_stamp = s.goals_stamp + 1ms; }),
               Change([](RobotState& s) { ++s.snapshots; }));
  StateBench bench;
  REQUIRE(bench.Give().size() == 1);
  bench.state.stamp = bench.state.stamp + 1ms;
  REQUIRE(bench.Give().empty());
  change(bench.state);
  CHECK(bench.Give().size() == 1);
}

TEST_CASE("over a link the path has the newest places", "[service]") {
  StateBench bench;
  bench.state.path = {{1, 1}, {1, 2}, {1, 3}, {2, 3}, {3, 3}};
  bench.state.cell = {3, 3};
  const auto given = bench.Give();
  REQUIRE(given.size() == 1);
  CHECK(given[0].value.path == std::vector<Cell>{{1, 3}, {2, 3}, {3, 3}});
  CHECK(given[0].value.cell == Cell{3, 3});
}

TEST_CASE("a robot without throttled states is followed, over a link too", "[service]") {
  StateBench bench;
  bench.publisher.reset();
  bench.topics->TakeStamped();
  CHECK(bench.topics->matched_publishers() == 0);
  bus::Publisher<conav_msgs::msg::RobotState> full(*bench.robot, bus::kRobotState, "r1");
  CHECK(bench.topics->matched_publishers() == 1);
  REQUIRE(bench.goals->Publish(ToMessage(GoalsOf(bench.state, 0.5))));
  bench.state.stamp = bench.state.stamp + 1s;
  REQUIRE(full.Publish(ToMessage(bench.state)));
  CHECK(bench.topics->TakeStamped().size() == 1);
  // Throttled states that are older than these are no new run.
  bus::Publisher<conav_msgs::msg::RobotState> late(*bench.robot, bus::kThrottledState, "r1");
  bench.bus->SetSourceDelay(10s);
  bench.state.stamp = bench.state.stamp + -500ms;
  REQUIRE(late.Publish(ToMessage(bench.state)));
  bench.topics->TakeStamped();
  CHECK(bench.topics->TakeStamped().empty());
  bench.bus->SetSourceDelay(0s);
  REQUIRE(late.Publish(ToMessage(bench.state)));
  CHECK(bench.topics->TakeStamped().size() == 1);
}

}  // namespace
}  // namespace conav
