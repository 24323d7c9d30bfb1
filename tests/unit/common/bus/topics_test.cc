#include "common/bus/topics.h"

#include <catch2/catch.hpp>

#include "common/bus/network.h"

namespace conav::bus {
namespace {

TEST_CASE("a topic's name is its pattern with the entity", "[bus][topics]") {
  CHECK(kRobotState.NameFor("r1") == "/r1/state");
  CHECK(kCameraImage.NameFor("r12") == "/r12/camera/image/compressed");
  CHECK(kBeliefMap.NameFor("w2") == "/w2/belief/map");
  CHECK(kClock.NameFor({}) == "/clock");
  CHECK(kClock.NameFor("r1") == "/clock");
}

TEST_CASE("ROS topics carry the rt prefix in DDS, the ROS graph does not", "[bus][topics]") {
  CHECK(DdsTopicName("/r1/state") == "rt/r1/state");
  CHECK(DdsTopicName("ros_discovery_info") == "ros_discovery_info");
}

TEST_CASE("late joiners get state, maps, commands and guidance", "[bus][topics]") {
  for (const Qos& qos : {kRobotMap.qos, kRobotState.qos, kRobotCommand.qos, kGuidance.qos,
                         kBelief.qos, kInitialMap.qos, kGoals.qos, kSnapshot.qos}) {
    CHECK(qos.durability == Durability::kTransientLocal);
    CHECK(qos.reliability == Reliability::kReliable);
  }
}

TEST_CASE("streams are best effort, requests keep all, queries the newest", "[bus][topics]") {
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

}  // namespace
}  // namespace conav::bus
