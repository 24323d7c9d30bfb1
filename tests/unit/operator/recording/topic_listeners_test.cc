#include <algorithm>
#include <catch2/catch.hpp>
#include <map>

#include "common/bus/in_memory_bus.h"
#include "common/bus/publisher.h"
#include "common/bus/topics.h"
#include "operator/recording/message_schemas.h"
#include "operator/recording/recorder_service.h"

namespace conav::recorder {
namespace {

struct Desk {
  std::shared_ptr<bus::InMemoryBus> bus = std::make_shared<bus::InMemoryBus>();
  bus::Participant recorder{"recorder", bus};
  bus::Participant robot{"robot", bus};
  Arrivals arrivals{1 << 20, [] {}, [] { return std::uint64_t{5}; }};
  std::map<std::uint16_t, TopicFacts> topics;

  std::uint16_t Add(const TopicFacts& topic) {
    const auto id = static_cast<std::uint16_t>(topics.size() + 1);
    topics[id] = topic;
    return id;
  }
  TopicListeners Listen(const RecorderConfig& config) {
    return {recorder, config, [this](const TopicFacts& topic) { return Add(topic); }, arrivals};
  }
  std::vector<std::string> Names() const {
    std::vector<std::string> names;
    for (const auto& [id, topic] : topics) names.push_back(topic.name);
    return names;
  }
  bool Has(const std::string& name) const {
    const auto names = Names();
    return std::find(names.begin(), names.end(), name) != names.end();
  }
};

TEST_CASE("Every topic of robots, worlds and system is listened to but the streams",
          "[operator][recorder]") {
  Desk desk;
  const auto listeners = desk.Listen({.robots = {"w1/r1", "w1/r2", "w2/r3"}});
  std::size_t expected = 0;
  const auto add = [&](std::size_t entities) {
    return [&expected, entities](const auto& topic) {
      if (topic.pattern != bus::kCameraImage.pattern) expected += entities;
    };
  };
  bus::ForEachRobotTopic(add(3));
  bus::ForEachWorldTopic(add(2));
  bus::ForEachSystemTopic(add(1));
  CHECK(listeners.topics() == expected);
  CHECK(desk.topics.size() == listeners.topics());
  CHECK(desk.Has("/r3/state"));
  CHECK(desk.Has("/w2/truth"));
  CHECK(desk.Has("/clock"));
  CHECK_FALSE(desk.Has("/r1/camera/image/compressed"));
}

TEST_CASE("Every topic's type has a definition", "[operator][recorder]") {
  Desk desk;
  const auto listeners = desk.Listen({.streams = true});
  CHECK(desk.Has("/r1/camera/image/compressed"));
  for (const auto& [id, topic] : desk.topics) {
    CAPTURE(topic.name, topic.type);
    CHECK(bag::ConavSchemas().TextOf(topic.type));
    CHECK_FALSE(topic.offered_qos.empty());
  }
}

TEST_CASE("Topics are left out by name or for all", "[operator][recorder]") {
  Desk desk;
  const auto listeners = desk.Listen(
      {.robots = {"w1/r1", "w1/r2"}, .exclude = {"/{}/odom", "/r1/tf", "/conav/planner/lease"}});
  CHECK_FALSE(desk.Has("/r1/odom"));
  CHECK_FALSE(desk.Has("/r2/odom"));
  CHECK_FALSE(desk.Has("/r1/tf"));
  CHECK(desk.Has("/r2/tf"));
  CHECK_FALSE(desk.Has("/conav/planner/lease"));
}

TEST_CASE("To leave out what is not there is refused", "[operator][recorder]") {
  Desk desk;
  CHECK_THROWS_WITH(desk.Listen({.exclude = {"/r7/odom"}}),
                    "recorder.exclude: '/r7/odom' is no topic of these robots");
  CHECK_THROWS_AS(desk.Listen({.robots = {"r1"}}), StartupError);
}

TEST_CASE("A message arrives as it was serialised, with the stamp of its header",
          "[operator][recorder]") {
  Desk desk;
  const auto listeners = desk.Listen({});
  bus::Publisher publisher(desk.robot, bus::kRobotState, "r1");
  conav_msgs::msg::RobotState state;
  state.header().stamp().sec(3);
  state.header().stamp().nanosec(4);
  state.robot("r1");
  state.cell_moves(9);
  REQUIRE(publisher.Publish(state));
  const auto arrivals = desk.arrivals.Take();
  REQUIRE(arrivals.size() == 1);
  CHECK(desk.topics.at(arrivals[0].channel).name == "/r1/state");
  CHECK(desk.topics.at(arrivals[0].channel).type == "conav_msgs/msg/RobotState");
  CHECK(arrivals[0].log_time == 5);
  CHECK(arrivals[0].publish_time == 3'000'000'004);
  conav_msgs::msg::RobotState read;
  REQUIRE(bus::TypeSupportOf<conav_msgs::msg::RobotState>().deserialize(arrivals[0].data, &read));
  CHECK(read == state);
}

TEST_CASE("A message without a header, or with a time before time, has the time of its arrival",
          "[operator][recorder]") {
  Desk desk;
  const auto listeners = desk.Listen({});
  bus::Publisher clock(desk.robot, bus::kClock);
  REQUIRE(clock.Publish({}));
  bus::Publisher states(desk.robot, bus::kRobotState, "r1");
  conav_msgs::msg::RobotState state;
  state.header().stamp().sec(-1);
  REQUIRE(states.Publish(state));
  const auto arrivals = desk.arrivals.Take();
  REQUIRE(arrivals.size() == 2);
  CHECK(arrivals[0].publish_time == 5);
  CHECK(arrivals[1].publish_time == 5);
}

}  // namespace
}  // namespace conav::recorder
