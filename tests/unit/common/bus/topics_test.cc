#include "common/bus/topics.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <regex>
#include <string>
#include <vector>

#include "common/bus/network.h"
#include "common/runtime/file.h"

namespace conav::bus {
namespace {

TEST_CASE("a topic's name is its pattern with the entity", "[topics]") {
  CHECK(kRobotState.NameFor("r1") == "/r1/state");
  CHECK(kCameraImage.NameFor("r12") == "/r12/camera/image/compressed");
  CHECK(kBeliefMap.NameFor("w2") == "/w2/belief/map");
  CHECK(kClock.NameFor({}) == "/clock");
  CHECK(kClock.NameFor("r1") == "/clock");
  // In DDS ROS topics carry the rt prefix, the ROS graph does not.
  CHECK(DdsTopicName("/r1/state") == "rt/r1/state");
  CHECK(DdsTopicName("ros_discovery_info") == "ros_discovery_info");
}

TEST_CASE(
    "late joiners get state, maps, commands and guidance; streams are best effort, requests "
    "keep all, queries the newest",
    "[topics]") {
  for (const Qos& qos : {kRobotMap.qos, kRobotState.qos, kRobotCommand.qos, kGuidance.qos,
                         kBelief.qos, kInitialMap.qos, kGoals.qos, kSnapshot.qos}) {
    CHECK(qos.durability == Durability::kTransientLocal);
    CHECK(qos.reliability == Reliability::kReliable);
  }
  CHECK(kCameraImage.qos.reliability == Reliability::kBestEffort);
  CHECK(kClock.qos.reliability == Reliability::kBestEffort);
  for (const Qos& qos : {kOperatorRequest.qos, kOperatorReply.qos}) {
    CHECK(qos.depth == 0);
    CHECK(qos.reliability == Reliability::kReliable);
  }
  for (const Qos& qos : {kPerceptionRequest.qos, kPerceptionReply.qos}) {
    CHECK(qos.depth > 0);
    CHECK(qos.reliability == Reliability::kReliable);
  }
}

/// The patterns of all topics that the text of topics.h declares.
std::vector<std::string> DeclaredPatterns() {
  const auto text = ReadFile(std::string(CONAV_SOURCE_DIR) + "/services/common/bus/topics.h");
  REQUIRE(text);
  const std::regex declaration("constexpr Topic<[^>]*>\\s*k\\w+\\{\\s*\"([^\"]*)\"");
  std::vector<std::string> patterns;
  for (std::sregex_iterator at(text->begin(), text->end(), declaration), end; at != end; ++at) {
    patterns.push_back((*at)[1]);
  }
  return patterns;
}

std::vector<std::string> ListedPatterns() {
  std::vector<std::string> patterns;
  const auto add = [&](const auto& topic) { patterns.emplace_back(topic.pattern); };
  ForEachTopic(kRobotTopics, add);
  ForEachTopic(kWorldTopics, add);
  ForEachTopic(kSystemTopics, add);
  return patterns;
}

TEST_CASE("the lists of topics hold every topic that is declared, once", "[topics]") {
  auto declared = DeclaredPatterns();
  auto listed = ListedPatterns();
  REQUIRE(declared.size() > 25);
  std::sort(declared.begin(), declared.end());
  std::sort(listed.begin(), listed.end());
  CHECK(listed == declared);
}

TEST_CASE("topics of robots and worlds have a place for their name, the others have none",
          "[topics]") {
  const auto has_place = [](const auto& topic) { CHECK(topic.pattern.starts_with("/{}/")); };
  ForEachTopic(kRobotTopics, has_place);
  ForEachTopic(kWorldTopics, has_place);
  ForEachTopic(kSystemTopics, [](const auto& topic) {
    CHECK(topic.pattern.find("{}") == std::string_view::npos);
  });
}

}  // namespace
}  // namespace conav::bus
