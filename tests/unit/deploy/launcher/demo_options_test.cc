#include "launcher/demo_options.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <filesystem>

#include "common/runtime/file.h"
#include "support/temporary_folder.h"

using conav::launcher::DemoOptions;
using conav::launcher::ParseRunWith;
using conav::launcher::Validate;
using conav::launcher::VendorOfService;

namespace {

std::string Refusal(const DemoOptions& options) {
  const auto result = Validate(options);
  return result ? "" : result.error().text;
}

}  // namespace

TEST_CASE("the default options of a demo are accepted", "[launcher][options]") {
  CHECK(Refusal({}) == "");
}

TEST_CASE("a demo without robots is refused by the option's name", "[launcher][options]") {
  DemoOptions options;
  options.robots = 0;
  CHECK_THAT(Refusal(options), Catch::Contains("--robots 0"));
  options.robots = 65;
  CHECK_THAT(Refusal(options), Catch::Contains("64"));
}

TEST_CASE("an unknown method is refused and the known ones are named", "[launcher][options]") {
  DemoOptions options;
  options.method = "magic";
  CHECK_THAT(Refusal(options),
             Catch::Contains("--method magic") && Catch::Contains("ig-mcts, instruction, teleop"));
}

TEST_CASE("a world turns by quarters only", "[launcher][options]") {
  DemoOptions options;
  for (const int good : {0, 90, 180, 270}) {
    options.rotation_deg = good;
    CHECK(Refusal(options) == "");
  }
  options.rotation_deg = 45;
  CHECK(Refusal(options) == "--rotation 45: not one of 0, 90, 180, 270");
  options.rotation_deg = 360;
  CHECK_THAT(Refusal(options), Catch::Contains("--rotation 360"));
}

TEST_CASE("a communication policy is one of those that there are, and ig-mcts's",
          "[launcher][options]") {
  DemoOptions options;
  options.communication = "often";
  CHECK_THAT(Refusal(options),
             Catch::Contains("--communication often") && Catch::Contains("when_blocked"));
  options.communication = "every";
  CHECK(Refusal(options) == "");
  options.method = "greedy";
  CHECK_THAT(Refusal(options), Catch::Contains("--communication every: --method greedy"));
  options.communication = "search";
  CHECK(Refusal(options) == "");
}

TEST_CASE("a model, weights or belief that do not exist are refused", "[launcher][options]") {
  DemoOptions options;
  options.model = "oracle";
  CHECK_THAT(Refusal(options), Catch::Contains("--model oracle: not one of nhpm, glpf"));
  options = {};
  options.weights = "/nowhere/a.nhpm";
  CHECK_THAT(Refusal(options), Catch::Contains("--weights /nowhere/a.nhpm: no such file"));
  options.weights = "/tmp";
  CHECK_THAT(Refusal(options), Catch::Contains("--weights /tmp: is a folder"));
  options = {};
  options.x_source = "guessed";
  CHECK_THAT(Refusal(options), Catch::Contains("--x-source guessed"));
}

TEST_CASE("a person and the folder of weights need each other", "[launcher][options]") {
  const conav::test::TemporaryFolder folder;
  DemoOptions options;
  options.person = "p07";
  CHECK_THAT(Refusal(options), Catch::Contains("--person and --person-weights need each other"));
  options.person_weights = folder.path();
  CHECK(Refusal(options) == "");
  options.person = "p 07";
  CHECK_THAT(Refusal(options), Catch::Contains("--person p 07: is not"));
  options.person = "p07";
  options.perception = "embedded";
  CHECK_THAT(Refusal(options), Catch::Contains("--person: --perception embedded"));
  options.perception = "remote";
  options.model = "glpf";
  CHECK_THAT(Refusal(options), Catch::Contains("--person: --model glpf"));
  options = {};
  options.person_weights = folder.path();
  CHECK_THAT(Refusal(options), Catch::Contains("need each other"));
  options.person = "p07";
  options.person_weights = "/nowhere";
  CHECK_THAT(Refusal(options), Catch::Contains("--person-weights /nowhere: no such folder"));
}

TEST_CASE("a result is not written over what the run reads", "[launcher][options]") {
  const conav::test::TemporaryFolder folder;
  DemoOptions options;
  options.weights = folder / "a.nhpm";
  options.json = folder / "a.nhpm";
  REQUIRE(conav::WriteFile(options.weights, ""));
  CHECK_THAT(Refusal(options), Catch::Contains("is the input --weights, too"));
}

TEST_CASE("options that would do nothing are refused", "[launcher][options]") {
  const conav::test::TemporaryFolder folder;
  DemoOptions options;
  options.model = "glpf";
  options.weights = folder / "a.nhpm";
  REQUIRE(conav::WriteFile(options.weights, ""));
  CHECK_THAT(Refusal(options), Catch::Contains("--weights: --model glpf has none"));
  options = {};
  options.perception = "embedded";
  options.nhpm_replicas = 2;
  CHECK_THAT(Refusal(options), Catch::Contains("--nhpm-replicas 2: with --perception embedded"));
}

TEST_CASE("numbers beyond their limits are refused", "[launcher][options]") {
  DemoOptions options;
  options.worlds = 17;
  CHECK_THAT(Refusal(options), Catch::Contains("--worlds"));
  options = {};
  options.planners = 17;
  CHECK_THAT(Refusal(options), Catch::Contains("--planners 17: not between 1 and 16"));
  options.planners = 1;
  options.nhpm_replicas = 0;
  CHECK_THAT(Refusal(options), Catch::Contains("--nhpm-replicas 0: not between 1 and 8"));
  options = {};
  options.speed = -1.0;
  CHECK_THAT(Refusal(options), Catch::Contains("--speed"));
  options = {};
  options.domain = 233;
  CHECK_THAT(Refusal(options), Catch::Contains("--domain"));
  options = {};
  options.time_limit_s = 0.0;
  CHECK_THAT(Refusal(options), Catch::Contains("--time-limit"));
}

TEST_CASE("map options are refused when a file is missing or stands alone", "[launcher][options]") {
  DemoOptions options;
  options.map = "/nowhere/plan.yaml";
  CHECK_THAT(Refusal(options), Catch::Contains("--map /nowhere/plan.yaml: no such file"));
  options = {};
  options.operator_map = "plan.yaml";
  CHECK_THAT(Refusal(options), Catch::Contains("needs --map"));
  options = {};
  options.cell_size_m = 0.5;
  CHECK_THAT(Refusal(options), Catch::Contains("--cell-size"));
}

TEST_CASE("an output folder that cannot be is refused", "[launcher][options]") {
  DemoOptions options;
  options.out = "/proc/self/status/runs";
  CHECK_THAT(Refusal(options), Catch::Contains("--out /proc/self/status/runs"));
  options = {};
  options.json = "/nowhere/result.json";
  CHECK_THAT(Refusal(options), Catch::Contains("--json /nowhere/result.json"));
}

TEST_CASE("a run is watchable on a terminal and as fast as commanded when headless",
          "[launcher][options]") {
  DemoOptions options;
  CHECK(options.effective_speed() == 2.0);
  CHECK(options.console_port() == 8080);
  CHECK(options.waits_for_operator());
  CHECK(std::isinf(options.effective_time_limit_s()));
  options.console = -1;
  CHECK(options.effective_speed() == 4.0);
  CHECK_FALSE(options.waits_for_operator());
  CHECK(options.effective_time_limit_s() == 1800.0);
  options.console.reset();
  options.headless = true;
  CHECK(options.effective_speed() == 0.0);
  options.speed = 2.0;
  CHECK(options.effective_speed() == 2.0);
}

TEST_CASE("one vendor is given to every process", "[launcher][options]") {
  const auto vendors = VendorOfService("fastdds");
  REQUIRE(vendors);
  CHECK(vendors->size() == 7);
  for (const auto& [service, vendor] : *vendors) CHECK(vendor == "fastdds");
}

TEST_CASE("a mixed demo has both vendors", "[launcher][options]") {
  const auto vendors = VendorOfService("mixed");
  REQUIRE(vendors);
  int fast = 0;
  for (const auto& [service, vendor] : *vendors) fast += vendor == "fastdds" ? 1 : 0;
  CHECK(fast == 3);
}

TEST_CASE("vendors are set per process and the rest keeps the default", "[launcher][options]") {
  const auto vendors = VendorOfService("sim=fastdds,planner=cyclonedds");
  REQUIRE(vendors);
  CHECK(vendors->at("sim") == "fastdds");
  CHECK(vendors->at("planner") == "cyclonedds");
  CHECK(vendors->at("nhpm").empty());
  CHECK_FALSE(VendorOfService("sim=rti"));
  CHECK_FALSE(VendorOfService("camera=fastdds"));
  CHECK_FALSE(VendorOfService("opendds"));
}

TEST_CASE("a run-with entry names a service and a command", "[launcher][options]") {
  const auto entry = ParseRunWith("sim=ip netns exec a");
  REQUIRE(entry);
  CHECK(entry->first == "sim");
  CHECK(entry->second == "ip netns exec a");
  CHECK_FALSE(ParseRunWith("sim"));
  CHECK_FALSE(ParseRunWith("sim= "));
  CHECK_FALSE(ParseRunWith("camera=nice"));
}
