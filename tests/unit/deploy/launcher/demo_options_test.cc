#include "launcher/demo_options.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <functional>

#include "common/runtime/file.h"
#include "support/temporary_folder.h"

namespace conav::launcher {
namespace {

struct Row {
  std::function<void(DemoOptions&)> set;
  std::string named;  // in the refusal, "" = accepted
};

void Check(const std::vector<Row>& rows) {
  for (const Row& row : rows) {
    DemoOptions options;
    row.set(options);
    INFO("expected: " << row.named);
    const auto result = Validate(options);
    CHECK(result.has_value() == row.named.empty());
    if (!result) CHECK_THAT(result.error().text, Catch::Contains(row.named));
  }
}

TEST_CASE("options beyond their limits are refused by name and value", "[launcher]") {
  using O = DemoOptions;
  Check({{[](O&) {}, ""},
         {[](O& o) { o.robots = 0; }, "--robots 0"},
         {[](O& o) { o.robots = 129; }, "--robots 129"},
         {[](O& o) { o.worlds = 17; }, "--worlds 17"},
         {[](O& o) { o.planners = 17; }, "--planners 17"},
         {[](O& o) { o.nhpm_replicas = 0; }, "--nhpm-replicas 0"},
         {[](O& o) { o.speed = -1.0; }, "--speed"},
         {[](O& o) { o.domain = 233; }, "--domain 233"},
         {[](O& o) { o.time_limit_s = 0.0; }, "--time-limit"},
         {[](O& o) { o.cell_size_m = 0.05; }, "--cell-size 0.05"},
         {[](O& o) { o.robot_radius_m = 3.0; }, "--radius 3"},
         {[](O& o) { o.water_level = -1.0; }, "--water-level -1"},
         {[](O& o) { o.resolution_m = 0.0; }, "--resolution 0"},
         {[](O& o) { o.rotation_deg = 270; }, ""},
         {[](O& o) { o.rotation_deg = 45; }, "--rotation 45"},
         {[](O& o) { o.rotation_deg = 360; }, "--rotation 360"},
         {[](O& o) { o.communication = "often"; }, "--communication often"},
         {[](O& o) { o.x_source = "guessed"; }, "--x-source guessed"},
         {[](O& o) { o.weights = "/nowhere/a.nhpm"; }, "--weights /nowhere/a.nhpm"},
         {[](O& o) { o.weights = "/tmp"; }, "--weights /tmp"},
         {[](O& o) { o.map = "/nowhere/plan.yaml"; }, "--map /nowhere/plan.yaml"},
         {[](O& o) { o.out = "/proc/self/status/runs"; }, "--out /proc/self/status/runs"},
         {[](O& o) { o.json = "/nowhere/result.json"; }, "--json /nowhere/result.json"}});
}

TEST_CASE("options that contradict each other or would do nothing are refused", "[launcher]") {
  using O = DemoOptions;
  const test::TemporaryFolder folder;
  const auto weights = folder / "a.nhpm";
  REQUIRE(WriteFile(weights, ""));
  const auto yaml = folder / "a.yaml", image = folder / "a.png";
  REQUIRE(WriteFile(yaml, ""));
  REQUIRE(WriteFile(image, ""));
  const auto with_person = [&](O& o) {
    o.person = "p07";
    o.person_weights = folder.path();
  };
  Check({{[](O& o) { o.communication = "every"; }, ""},
         {[](O& o) { o.communication = "every", o.method = MethodKind::kGreedy; },
          "--communication every"},
         {[](O& o) { o.communication = "search", o.method = MethodKind::kGreedy; }, ""},
         {with_person, ""},
         {[](O& o) { o.scenario = "paper", o.preset = "9x9"; }, "--scenario paper"},
         {[](O& o) { o.scenario = "no-map", o.x_source = "estimated"; }, "--scenario no-map"},
         {[](O& o) { o.person = "p07"; }, "--person and --person-weights"},
         {[&](O& o) { o.person_weights = folder.path(); }, "--person and --person-weights"},
         {[&](O& o) { with_person(o), o.person = "p 07"; }, "--person p 07"},
         {[&](O& o) { with_person(o), o.perception = "embedded"; }, "--perception embedded"},
         {[&](O& o) { with_person(o), o.model = PerceptionModelKind::kGlpf; }, "--model glpf"},
         {[&](O& o) { with_person(o), o.person_weights = "/none"; }, "--person-weights /none"},
         {[&](O& o) { o.weights = o.json = weights; }, "--weights"},
         {[&](O& o) { o.weights = weights, o.model = PerceptionModelKind::kGlpf; }, "--model glpf"},
         {[](O& o) { o.nhpm_replicas = 2, o.perception = "embedded"; }, "--nhpm-replicas 2"},
         {[](O& o) { o.operator_map = "plan.yaml"; }, "needs --map"},
         {[](O& o) { o.cell_size_m = 0.5; }, "--cell-size"},
         {[&](O& o) { o.map = yaml, o.cell_size_m = 0.1, o.robot_radius_m = 0.3; }, ""},
         {[&](O& o) { o.map = yaml, o.robot_radius_m = 0.3; }, "--radius"},
         {[&](O& o) { o.map = yaml, o.cell_size_m = 0.1, o.method = MethodKind::kTeleop; },
          "--method teleop"},
         {[&](O& o) { o.map = yaml, o.water_level = 90.0; }, "--water-level"},
         {[&](O& o) { o.map = yaml, o.resolution_m = 0.1; }, "--resolution"},
         {[&](O& o) { o.map = image, o.water_level = 90.0, o.resolution_m = 0.5; }, ""},
         {[&](O& o) { o.map = image, o.operator_map = yaml; }, "--operator-map"},
         {[](O& o) { o.world = "waterway"; }, ""},
         {[](O& o) { o.world = "sea"; }, "--world sea"},
         {[](O& o) { o.world = "waterway", o.preset = "large26"; }, "--preset large26"},
         {[](O& o) { o.world = "waterway", o.method = MethodKind::kTeleop; }, "--method teleop"},
         {[](O& o) { o.streams = true, o.recording = false; }, "--streams"}});
}

TEST_CASE("a run is watchable on a terminal and as fast as commanded when headless", "[launcher]") {
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

TEST_CASE("a demo has one vendor, both, or one per process", "[launcher]") {
  const auto fast_of = [](const std::string& dds) {
    const auto vendors = VendorOfService(dds);
    REQUIRE(vendors);
    REQUIRE(vendors->size() == 7);
    return std::count_if(vendors->begin(), vendors->end(),
                         [](const auto& entry) { return entry.second == bus::Vendor::kFastDds; });
  };
  CHECK(fast_of("fastdds") == 7);
  CHECK(fast_of("mixed") == 3);
  const auto vendors = VendorOfService("sim=fastdds,planner=cyclonedds");
  REQUIRE(vendors);
  CHECK(vendors->at("sim") == bus::Vendor::kFastDds);
  CHECK(vendors->at("planner") == bus::Vendor::kCycloneDds);
  CHECK_FALSE(vendors->at("nhpm"));  // keeps the default
  for (const char* wrong : {"sim=rti", "camera=fastdds", "opendds"}) {
    CHECK_FALSE(VendorOfService(wrong));
  }
}

TEST_CASE("a run-with entry names a service and a command", "[launcher]") {
  CHECK(ParseRunWith("sim=ip netns exec a").value() ==
        std::pair<std::string, std::string>("sim", "ip netns exec a"));
  for (const char* wrong : {"sim", "sim= ", "camera=nice"}) CHECK_FALSE(ParseRunWith(wrong));
}

}  // namespace
}  // namespace conav::launcher
