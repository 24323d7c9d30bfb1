// A whole system with DDS security: what the keystore permits each program is what it needs.
#include <unistd.h>

#include <catch2/catch.hpp>

#include "keystore/keystore.h"
#include "system/launcher/demo_run.h"

namespace conav::testing {
namespace {

TEST_CASE("a secured demo of either vendor, and of both, reaches all goals", "[system][security]") {
  const std::string vendor = GENERATE("cyclonedds", "fastdds", "mixed");
  CAPTURE(vendor);
  const test::TemporaryFolder folder;
  const std::string keys = folder / "keys";
  char host[256] = "";
  REQUIRE(gethostname(host, sizeof host - 1) == 0);
  keystore::Init(keys, 30);
  keystore::Add(
      keys, {keystore::HostFolder(host), {keystore::kRoles.begin(), keystore::kRoles.end()}, {}},
      10);
  DemoRun demo(
      "--headless --seed 7 --ros humble --dds " + vendor,
      "env ROS_SECURITY_ENABLE=true ROS_SECURITY_STRATEGY=Enforce ROS_SECURITY_KEYSTORE=" + keys);
  demo.ReachesAllGoals();
  CHECK(demo.Story().find("Not Allowed") == std::string::npos);
}

}  // namespace
}  // namespace conav::testing
