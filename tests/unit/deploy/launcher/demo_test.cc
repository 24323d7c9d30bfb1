#include "launcher/demo.h"

#include <catch2/catch.hpp>

namespace conav::launcher {
namespace {

PlannerLease Says(const std::string& node, std::vector<PlannerLease::Held> holds) {
  return {.node = node, .instance = node + "-1", .holds = std::move(holds)};
}

TEST_CASE("the first drivers are reported once, where that is wanted", "[launcher]") {
  PlannerMonitor watch(true);
  CHECK_THAT(watch.Fold(Says("planner-1", {{"r1", 1}, {"r3", 1}})),
             Catch::Contains("planner-1") && Catch::Contains("r1, r3"));
  CHECK(watch.Fold(Says("planner-1", {{"r1", 1}, {"r3", 1}})).empty());
  CHECK(PlannerMonitor(false).Fold(Says("planner", {{"r1", 1}})).empty());
}

TEST_CASE("a takeover is reported with both planners", "[launcher]") {
  PlannerMonitor watch(false);
  watch.Fold(Says("planner-1", {{"r1", 1}, {"r3", 1}}));
  watch.Fold(Says("planner-2", {{"r2", 1}}));
  CHECK_THAT(
      watch.Fold(Says("planner-2", {{"r1", 2}, {"r2", 1}, {"r3", 2}})),
      Catch::StartsWith("planner-2") && Catch::Contains("r1, r3") && Catch::EndsWith("planner-1"));
}

TEST_CASE("an announcement from before a takeover, or of one's own robots, is no news",
          "[launcher]") {
  PlannerMonitor watch(true);
  watch.Fold(Says("planner-1", {{"r1", 1}}));
  CHECK(watch.Fold(Says("planner-1", {{"r1", 2}})).empty());
  watch.Fold(Says("planner-2", {{"r1", 3}}));
  CHECK(watch.Fold(Says("planner-1", {{"r1", 2}})).empty());
}

}  // namespace
}  // namespace conav::launcher
