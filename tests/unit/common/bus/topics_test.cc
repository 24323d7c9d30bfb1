#include "common/bus/topics.h"

#include <fmt/core.h>

#include <catch2/catch.hpp>
#include <iostream>
#include <string>
#include <string_view>

#include "common/bus/network.h"
#include "common/bus/services.h"
#include "common/bus/type_support.h"
#include "common/runtime/file.h"

namespace conav::bus {
namespace {

/// The words of the README's table.
std::string Words(const Qos& qos) {
  const bool latched = qos.durability == Durability::kTransientLocal;
  if (qos.reliability == Reliability::kBestEffort) {
    return fmt::format("best effort, last {}", qos.depth);
  }
  if (latched && qos.depth == 1) return "latched";
  if (qos.depth == 0) return "reliable, all";
  return fmt::format("{}, last {}", latched ? "latched" : "reliable", qos.depth);
}

/// "conav_msgs::msg::dds_::RobotState_" as ROS 2 writes it: "conav_msgs/RobotState".
std::string RosType(std::string_view dds_name) {
  const auto package = dds_name.substr(0, dds_name.find("::"));
  const auto name = dds_name.substr(dds_name.rfind("::") + 2);
  return fmt::format("{}/{}", package, name.substr(0, name.size() - 1));
}

/// "| `/<robot>/state` | conav_msgs/RobotState | sim -> all | latched |" for each topic.
std::string Table() {
  std::string table;
  const auto rows_of = [&](std::string_view entity) {
    return [&table, entity](const auto& topic) {
      using T = typename std::decay_t<decltype(topic)>::Type;
      table += fmt::format("| `{}` | {}{}{} | {} | {} |\n", topic.NameFor(entity),
                           RosType(TypeSupportOf<T>().name), topic.about.empty() ? "" : ": ",
                           topic.about, topic.direction, Words(topic.qos));
    };
  };
  ForEachRobotTopic(rows_of("<robot>"));
  ForEachWorldTopic(rows_of("<world>"));
  ForEachSystemTopic(rows_of(""));
  return table;
}

TEST_CASE("the README's table of topics is that of the code", "[topics]") {
  const auto readme = ReadFile(std::string(CONAV_SOURCE_DIR) + "/README.md");
  REQUIRE(readme);
  const bool same = readme->find(Table()) != std::string::npos;
  if (!same) std::cout << "put this table into README.md:\n" << Table();
  CHECK(same);
}

/// "| `/<robot>/stop` | std_srvs/Trigger | operator | the robot stands still |" for each service and action.
std::string ServiceTable() {
  std::string table;
  const auto add = [&table](const auto& offered, const std::string& type, const std::string& end) {
    table += fmt::format("| `{}` | {} | {} | {} |\n",
                         offered.NameFor(fmt::format("<{}>", offered.entity)),
                         type.substr(0, type.size() - end.size()), offered.server, offered.about);
  };
  ForEachService([&](const auto& service) {
    using Request = typename std::decay_t<decltype(service)>::Request;
    add(service, RosType(TypeSupportOf<Envelope<Request>>().name), "_Request");
  });
  ForEachAction([&](const auto& action) {
    using Feedback = typename std::decay_t<decltype(action)>::Types::FeedbackMessage;
    add(action, RosType(TypeSupportOf<Feedback>().name), "_FeedbackMessage");
  });
  return table;
}

TEST_CASE("the table of services and actions in docs/ros2.md is that of the code", "[topics]") {
  const auto text = ReadFile(std::string(CONAV_SOURCE_DIR) + "/docs/ros2.md");
  REQUIRE(text);
  const bool same = text->find(ServiceTable()) != std::string::npos;
  if (!same) std::cout << "put this table into docs/ros2.md:\n" << ServiceTable();
  CHECK(same);
}

TEST_CASE("in DDS ROS topics carry the prefix rt, the ROS graph does not", "[topics]") {
  CHECK(DdsTopicName("/r1/state") == "rt/r1/state");
  CHECK(DdsTopicName("ros_discovery_info") == "ros_discovery_info");
}

}  // namespace
}  // namespace conav::bus
