#include <yaml-cpp/yaml.h>

#include <catch2/catch.hpp>

#include "operator/recording/recorder_service.h"

namespace conav::recorder {
namespace {

YAML::Node Profile(const bus::Qos& qos) {
  const YAML::Node list = YAML::Load(OfferedQosText(qos));
  REQUIRE(list.size() == 1);
  return list[0];
}

TEST_CASE("A latched topic is reliable, transient local, keep last 1", "[operator][recorder]") {
  const YAML::Node profile = Profile(bus::kLatchedQos);
  CHECK(profile["history"].as<int>() == 1);
  CHECK(profile["depth"].as<int>() == 1);
  CHECK(profile["reliability"].as<int>() == 1);
  CHECK(profile["durability"].as<int>() == 1);
}

TEST_CASE("A sensor's topic is best effort and volatile", "[operator][recorder]") {
  const YAML::Node profile = Profile(bus::kSensorQos);
  CHECK(profile["depth"].as<int>() == 5);
  CHECK(profile["reliability"].as<int>() == 2);
  CHECK(profile["durability"].as<int>() == 2);
}

TEST_CASE("Keep all has a history of its own, and nothing ends", "[operator][recorder]") {
  const YAML::Node profile = Profile(bus::kRequestQos);
  CHECK(profile["history"].as<int>() == 2);
  for (const char* duration : {"deadline", "lifespan", "liveliness_lease_duration"}) {
    CHECK(profile[duration]["sec"].as<std::int64_t>() == 9223372036);
    CHECK(profile[duration]["nsec"].as<std::int64_t>() == 854775807);
  }
}

}  // namespace
}  // namespace conav::recorder
