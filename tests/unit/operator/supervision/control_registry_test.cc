#include <catch2/catch.hpp>
#include <utility>

#include "operator/supervision/control.h"

namespace conav::operators {
namespace {

using namespace std::chrono_literals;

const std::map<std::string, std::string> kRobots{{"r1", "w1"}, {"r2", "w1"}, {"r3", "w2"}};

struct Bench {
  ControlRegistry registry{kRobots, ControlOptions{60.0, false}};
  Clock::TimePoint now{};
};

TEST_CASE("Who has control of a robot commands it alone, before that everybody does",
          "[operator][control]") {
  Bench bench;
  CHECK(bench.registry.CheckCommand("anna", "r1", bench.now).empty());
  CHECK(bench.registry.CheckCommand("ben", "r1", bench.now).empty());
  REQUIRE(bench.registry.Take("anna", {{"r1"}, ""}, bench.now));
  CHECK(bench.registry.CheckCommand("anna", "r1", bench.now).empty());
  CHECK(bench.registry.CheckCommand("ben", "r1", bench.now) ==
        "anna has control of r1: take over first");
  CHECK(bench.registry.CheckCommand("ben", "r2", bench.now).empty());
}

TEST_CASE("Taking over asks for a reason, then the other one commands", "[operator][control]") {
  Bench bench;
  REQUIRE(bench.registry.Take("anna", {{"r1"}, ""}, bench.now));
  const auto refused = bench.registry.Take("ben", {{"r2", "r1"}, ""}, bench.now);
  REQUIRE_FALSE(refused);
  CHECK(refused.error().text == "anna has control of r1: say why you take over");
  CHECK(bench.registry.robots().at("r2").holder.empty());
  REQUIRE(bench.registry.Take("ben", {{"r1"}, "shift change"}, bench.now));
  CHECK(bench.registry.robots().at("r1").reason == "shift change");
  CHECK_FALSE(bench.registry.CheckCommand("anna", "r1", bench.now).empty());
}

TEST_CASE("Control ends by release, by leaving, and when nothing is asked for a minute",
          "[operator][control]") {
  Bench bench;
  REQUIRE(bench.registry.Take("anna", {{}, ""}, bench.now));
  REQUIRE(bench.registry.Release("ben", {{"r1"}}));
  CHECK(bench.registry.robots().at("r1").holder == "anna");
  REQUIRE(bench.registry.Release("anna", {{"r1"}}));
  CHECK(bench.registry.robots().at("r1").holder.empty());
  bench.registry.Renew("anna", bench.now + 59s);
  CHECK_FALSE(bench.registry.CheckCommand("ben", "r2", bench.now + 118s).empty());
  CHECK(bench.registry.CheckCommand("ben", "r2", bench.now + 119s).empty());
  bench.registry.Expire(bench.now + 119s);
  CHECK(bench.registry.robots().at("r2").holder.empty());
  REQUIRE(bench.registry.Take("anna", {{}, ""}, bench.now));
  bench.registry.ReleaseAll("anna");
  CHECK(bench.registry.robots().at("r3").holder.empty());
}

TEST_CASE("The map of a world belongs to who has control of all its robots",
          "[operator][control]") {
  Bench bench;
  REQUIRE(bench.registry.Take("anna", {{"r1"}, ""}, bench.now));
  CHECK(bench.registry.CheckEdit("ben", "w1", bench.now).empty());
  REQUIRE(bench.registry.Take("anna", {{"r2"}, ""}, bench.now));
  CHECK(bench.registry.CheckEdit("ben", "w1", bench.now) ==
        "anna has control of all robots of w1: take over first");
  CHECK(bench.registry.CheckEdit("anna", "w1", bench.now).empty());
  CHECK(bench.registry.CheckEdit("ben", "w2", bench.now).empty());
}

TEST_CASE("Anybody may stop robots under any control, orders count once they are adopted",
          "[operator][control]") {
  Bench bench;
  REQUIRE(bench.registry.Take("anna", {{}, ""}, bench.now));
  const auto orders = bench.registry.Stop("ben", {{}, "fire"}, {5});
  REQUIRE(orders);
  REQUIRE(orders->size() == 3);
  CHECK((*orders)[2] == StopOrder{{5}, "w2", "r3", 1, true, "ben", "fire"});
  CHECK_FALSE(bench.registry.robots().at("r3").stop.stopped);
  for (const StopOrder& order : *orders) bench.registry.Adopt(order);
  CHECK(bench.registry.robots().at("r3").stop.stopped);
  CHECK(bench.registry.Stop("ben", {{"r3"}, ""}, {6})->empty());
  const auto resumed = bench.registry.Resume("anna", {{"r3"}}, {7});
  REQUIRE(resumed->size() == 1);
  CHECK(resumed->front().revision == 2);
  CHECK_FALSE(resumed->front().stopped);
}

TEST_CASE("A robot that is not known is refused by name", "[operator][control]") {
  Bench bench;
  CHECK(bench.registry.Stop("ben", {{"r1", "r9"}, ""}, {}).error().text == "robot 'r9' is unknown");
  CHECK_FALSE(bench.registry.Take("ben", {{"r9"}, ""}, bench.now));
  CHECK_FALSE(bench.registry.Release("ben", {{"r9"}}));
}

TEST_CASE("Robots may stand from the start until somebody lets them go", "[operator][control]") {
  const ControlRegistry registry(kRobots, ControlOptions{60.0, true});
  CHECK(registry.robots().at("r1").stop.stopped);
  CHECK(registry.robots().at("r1").stop.revision == 1);
  CHECK(registry.Resume("anna", {{"r1"}}, {})->front().revision == 2);
}

TEST_CASE("The version rises with every change", "[operator][control]") {
  Bench bench;
  std::uint64_t last = bench.registry.version();
  const auto changed = [&] { return std::exchange(last, bench.registry.version()) != last; };
  REQUIRE(bench.registry.Take("anna", {{"r1"}, ""}, bench.now));
  CHECK(changed());
  bench.registry.Renew("ben", bench.now);
  CHECK_FALSE(changed());
  bench.registry.Expire(bench.now + 61s);
  CHECK(changed());
  bench.registry.Expire(bench.now + 62s);
  CHECK_FALSE(changed());
  bench.registry.Adopt({{}, "w1", "r1", 1, true, "ben", ""});
  CHECK(changed());
}

}  // namespace
}  // namespace conav::operators
