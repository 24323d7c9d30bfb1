#include "common/bus/participant.h"

#include <catch2/catch.hpp>

#include "common/bus/backend.h"
#include "common/runtime/config.h"
#include "common/runtime/result.h"
#include "support/scoped_variable.h"

namespace conav::bus {
namespace {

using test::ScopedVariable;

TEST_CASE("the environment fills what the options leave open, options go before it", "[options]") {
  const ScopedVariable vendor("CONAV_DDS", "fastdds");
  const ScopedVariable domain("CONAV_DOMAIN", "42");
  const ScopedVariable interface("CONAV_INTERFACE", "lo");
  const ParticipantOptions resolved = Resolve({});
  CHECK(resolved.vendor == Vendor::kFastDds);
  CHECK(resolved.domain_id == 42);
  CHECK(resolved.interface == "lo");
  ParticipantOptions options;
  options.vendor = Vendor::kCycloneDds;
  options.domain_id = 7;
  CHECK(Resolve(options).vendor == Vendor::kCycloneDds);
  CHECK(Resolve(options).domain_id == 7);
}

TEST_CASE("without options the vendor is the default one, the domain ROS_DOMAIN_ID or 0",
          "[options]") {
  const ScopedVariable vendor("CONAV_DDS", "");
  const ScopedVariable domain("CONAV_DOMAIN", "");
  for (const auto& [ros_domain, expected] : {std::pair("13", 13), std::pair("", 0)}) {
    const ScopedVariable ros("ROS_DOMAIN_ID", ros_domain);
    CHECK(Resolve({}).vendor == kDefaultVendor);
    CHECK(Resolve({}).domain_id == expected);
  }
}

TEST_CASE(
    "the graph has the layout of ROS_DISTRO, an option goes before it, none is published else",
    "[options]") {
  using enum RosDistribution;
  for (const auto& [ros_distro, expected] :
       {std::pair("", kNone), std::pair("noetic", kNone), std::pair("galactic", kHumble),
        std::pair("humble", kHumble), std::pair("iron", kJazzy), std::pair("jazzy", kJazzy)}) {
    const ScopedVariable ros("ROS_DISTRO", ros_distro);
    CAPTURE(ros_distro);
    CHECK(Resolve({}).ros_distribution == expected);
    ParticipantOptions options;
    options.ros_distribution = kNone;
    CHECK(Resolve(options).ros_distribution == kNone);
  }
}

TEST_CASE("a process belongs to the system conav unless options or the environment name another",
          "[options]") {
  const ScopedVariable none("CONAV_SYSTEM", nullptr);
  CHECK(Resolve({}).system == kDefaultSystem);
  const ScopedVariable lab("CONAV_SYSTEM", "lab");
  CHECK(Resolve({}).system == "lab");
  ParticipantOptions options;
  options.system = "field-2.b";
  CHECK(Resolve(options).system == "field-2.b");
  for (const std::string& name : {std::string("a;b"), std::string("a=b"), std::string(65, 'x')}) {
    options.system = name;
    CAPTURE(name);
    CHECK_THROWS_WITH(Resolve(options), Catch::Contains("system"));
  }
}

TEST_CASE("an unknown vendor is refused with those that exist", "[options]") {
  const ScopedVariable vendor("CONAV_DDS", "opensplice");
  CHECK_THROWS_WITH(Participant("node", ParticipantOptions{}),
                    Catch::Contains("CONAV_DDS = opensplice") && Catch::Contains("cyclonedds") &&
                        Catch::Contains("fastdds"));
}

TEST_CASE("a domain that DDS does not have is refused", "[options]") {
  ParticipantOptions options;
  options.domain_id = 233;
  CHECK_THROWS_WITH(Resolve(options), Catch::Contains("233") && Catch::Contains("232"));
  const ScopedVariable domain("CONAV_DOMAIN", GENERATE("233", "-3", "7x", "seven"));
  CHECK_THROWS_AS(Resolve({}), StartupError);
}

TEST_CASE("the section bus of a config file is read and checked", "[options]") {
  const auto read = [](const char* text) {
    ParticipantOptions options;
    ReadConfig(YAML::Load(text), "sim.bus", options);
    return options;
  };
  const ParticipantOptions options =
      read("{vendor: fastdds, domain_id: 5, interface: lo, peers: [10.0.0.1], lease_s: 1.5}");
  CHECK(options.vendor == Vendor::kFastDds);
  CHECK(options.peers == std::vector<std::string>{"10.0.0.1"});
  CHECK(options.lease_s == 1.5);
  for (const auto& [text, names] :
       {std::pair("{vendor: rti}", "rti"), std::pair("{domain_id: 300}", "domain_id"),
        std::pair("{lease_s: 0}", "lease_s"), std::pair("{ros_distribution: foxy}", "foxy")}) {
    CHECK_THROWS_WITH(read(text), Catch::Contains(names));
  }
}

}  // namespace
}  // namespace conav::bus
