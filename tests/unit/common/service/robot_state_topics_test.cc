#include "common/service/robot_state_topics.h"

#include <catch2/catch.hpp>

#include "common/bus/in_memory_bus.h"
#include "unit/common/msg/samples.h"

namespace conav {
namespace {

using namespace std::chrono_literals;

/// A robot and who reads its states, over a link or on one machine.
struct StateBench {
  explicit StateBench(bool over_link) {
    if (over_link) bus->SetOverLink();
    reader.emplace("reader", bus);
    states.emplace(*reader, bus::kRobotState, "r1");
  }
  /// The states that arrive after one that was given.
  std::size_t Give(const RobotState& state) {
    publisher.Publish(state, clock.Now());
    return states->Take().size();
  }

  std::shared_ptr<bus::InMemoryBus> bus = std::make_shared<bus::InMemoryBus>();
  FakeClock clock;
  bus::Participant robot{"robot", bus};
  RobotStatePublisher publisher{robot, "r1"};
  std::optional<bus::Participant> reader;
  std::optional<bus::Subscriber<conav_msgs::msg::RobotState>> states;
  RobotState state = samples::SampleState();
};

TEST_CASE("over a link a robot that only moves sends a state every 0.5 s of its time",
          "[service]") {
  StateBench bench(true);
  CHECK(bench.Give(bench.state) == 1);
  for (const std::size_t sent : {0U, 1U, 0U, 1U}) {
    bench.state.stamp = bench.state.stamp + 250ms;
    bench.state.position.x_m += 0.1;
    bench.state.low_level_steps += 1;
    CHECK(bench.Give(bench.state) == sent);
  }
  bench.clock.Advance(1s);  // its time stands still
  CHECK(bench.Give(bench.state) == 1);
  bench.state.stamp = {};  // it has begun again
  CHECK(bench.Give(bench.state) == 1);
}

TEST_CASE("on one machine, and while anybody asks for the full rate, no state is left out",
          "[service]") {
  const bool over_link = GENERATE(true, false);
  StateBench bench(over_link);
  std::optional<bus::Subscriber<conav_msgs::msg::RobotState>> tool;
  if (over_link) tool.emplace(*bench.reader, bus::Dense(bus::kRobotState), "r1");
  CHECK(bench.Give(bench.state) == 1);
  CHECK(bench.Give(bench.state) == 1);
  if (!tool) return;
  tool.reset();
  CHECK(bench.Give(bench.state) == 0);
}

TEST_CASE("what a decision or a person waits for is sent at once", "[service]") {
  using Change = void (*)(RobotState&);
  const Change change =
      GENERATE(Change([](RobotState& s) { ++s.command_sequence_number; }),
               Change([](RobotState& s) { s.command_outcome = CommandOutcome::kDone; }),
               Change([](RobotState& s) { s.command_detail = "another wall"; }),
               Change([](RobotState& s) { ++s.drive_order; }),
               Change([](RobotState& s) { ++s.lease_epoch; }),
               Change([](RobotState& s) { s.stopped = false; }),
               Change([](RobotState& s) { ++s.stop_revision; }),
               Change([](RobotState& s) { s.map_stamp = s.map_stamp + 1ms; }),
               Change([](RobotState& s) { s.goals_stamp = s.goals_stamp + 1ms; }),
               Change([](RobotState& s) { ++s.snapshots; }), Change([](RobotState& s) {
                 s.path.push_back({4, 4});
               }));
  StateBench bench(true);
  REQUIRE(bench.Give(bench.state) == 1);
  REQUIRE(bench.Give(bench.state) == 0);
  change(bench.state);
  CHECK(bench.Give(bench.state) == 1);
}

}  // namespace
}  // namespace conav
