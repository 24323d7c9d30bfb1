#include <catch2/catch.hpp>
#include <utility>

#include "operator/supervision/control.h"

namespace conav::operators {
namespace {

using namespace std::chrono_literals;

const std::map<std::string, std::string> kRobots{{"r1", "w1"}, {"r2", "w1"}, {"r3", "w2"}};

struct ControlBench {
  ControlRegistry registry{kRobots, ControlOptions{60.0, false}};
  Clock::TimePoint now{};
};

TEST_CASE_METHOD(ControlBench,
                 "Who has control of a robot commands it alone, before that everybody does",
                 "[operator][control]") {
  CHECK(registry.CheckCommand("anna", "r1", now).empty());
  CHECK(registry.CheckCommand("ben", "r1", now).empty());
  REQUIRE(registry.Take("anna", {{"r1"}, ""}, now));
  CHECK(registry.CheckCommand("anna", "r1", now).empty());
  CHECK_THAT(registry.CheckCommand("ben", "r1", now),
             Catch::StartsWith("anna") && Catch::Contains("r1"));
  CHECK(registry.CheckCommand("ben", "r2", now).empty());
}

TEST_CASE_METHOD(ControlBench, "Taking over asks for a reason, then the other one commands",
                 "[operator][control]") {
  REQUIRE(registry.Take("anna", {{"r1"}, ""}, now));
  const auto refused = registry.Take("ben", {{"r2", "r1"}, ""}, now);
  REQUIRE_FALSE(refused);
  CHECK_THAT(refused.error().text, Catch::StartsWith("anna") && Catch::Contains("r1"));
  CHECK(registry.robots().at("r2").holder.empty());
  REQUIRE(registry.Take("ben", {{"r1"}, "shift change"}, now));
  CHECK(registry.robots().at("r1").reason == "shift change");
  CHECK_FALSE(registry.CheckCommand("anna", "r1", now).empty());
}

TEST_CASE_METHOD(ControlBench,
                 "Control ends by release, by leaving, and when nothing is asked for a minute",
                 "[operator][control]") {
  REQUIRE(registry.Take("anna", {{}, ""}, now));
  REQUIRE(registry.Release("ben", {{"r1"}}, now));
  CHECK(registry.robots().at("r1").holder == "anna");
  REQUIRE(registry.Release("anna", {{"r1"}}, now));
  CHECK(registry.robots().at("r1").holder.empty());
  registry.Renew("anna", now + 59s);
  CHECK_FALSE(registry.CheckCommand("ben", "r2", now + 118s).empty());
  CHECK(registry.CheckCommand("ben", "r2", now + 119s).empty());
  registry.Expire(now + 119s);
  CHECK(registry.robots().at("r2").holder.empty());
  REQUIRE(registry.Take("anna", {{}, ""}, now));
  registry.ReleaseAll("anna", now);
  CHECK(registry.robots().at("r3").holder.empty());
}

TEST_CASE_METHOD(ControlBench, "Control that is asked for is handed over by releasing it, or kept",
                 "[operator][control]") {
  const TakeControlRequest ask{{"r1"}, "lunch is over", true};
  const ControlRegistry::Robot& r1 = registry.robots().at("r1");
  REQUIRE(registry.Take("anna", {{"r1"}, ""}, now));
  REQUIRE(registry.Take("ben", ask, now));
  CHECK((r1.holder == "anna" && r1.asked_by == "ben" && r1.ask_reason == ask.reason));
  CHECK_THAT(registry.Take("carl", ask, now).error().text, Catch::StartsWith("ben"));
  SECTION("released, or its holder leaves") {
    const std::string to = GENERATE("", "ben");
    CHECK_FALSE(registry.Release("anna", {{"r1"}, "carl"}, now));
    to.empty() ? registry.ReleaseAll("anna", now)
               : void(registry.Release("anna", {{"r1"}, to}, now));
    CHECK((r1.holder == "ben" && r1.held_until == now + 60s));
  }
  SECTION("kept") {
    REQUIRE(registry.Take("anna", {{"r1"}, ""}, now));
    REQUIRE(registry.Release("anna", {{"r1"}}, now));
    CHECK(r1.holder.empty());
  }
  SECTION("not answered in time, or its client leaves") {
    GENERATE(0, 1) == 0 ? registry.Expire(now + ControlRegistry::kAskedFor)
                        : registry.ReleaseAll("ben", now);
    CHECK(r1.holder == "anna");
  }
  CHECK(r1.asked_by.empty());
  REQUIRE(registry.Take("carl", {{"r2"}, "", true}, now));  // nobody has it
  CHECK(registry.robots().at("r2").holder == "carl");
}

TEST_CASE_METHOD(ControlBench, "The map of a world belongs to who has control of all its robots",
                 "[operator][control]") {
  REQUIRE(registry.Take("anna", {{"r1"}, ""}, now));
  CHECK(registry.CheckEdit("ben", "w1", now).empty());
  REQUIRE(registry.Take("anna", {{"r2"}, ""}, now));
  CHECK_THAT(registry.CheckEdit("ben", "w1", now),
             Catch::StartsWith("anna") && Catch::Contains("w1"));
  CHECK(registry.CheckEdit("anna", "w1", now).empty());
  CHECK(registry.CheckEdit("ben", "w2", now).empty());
}

TEST_CASE_METHOD(ControlBench,
                 "A robot that another program resumed is stopped again by a newer order",
                 "[operator][control][stop]") {
  const auto orders = registry.Stop("anna", {{"r1"}, "a cat"}, {5});
  REQUIRE(orders);
  registry.Adopt(orders->at(0));
  RobotState state{.stamp = {9}, .world = "w1", .robot = "r1"};
  CHECK_FALSE(registry.Receive(state));  // the order has not arrived yet
  state.stopped = true;
  state.stop_revision = 1;
  CHECK_FALSE(registry.Receive(state));
  state.stopped = false;
  state.stop_revision = 7;
  const auto again = registry.Receive(state);
  REQUIRE(again);
  CHECK(again->stopped);
  CHECK(again->revision == 8);
  CHECK(again->given_by == "anna");
  registry.Adopt(*again);
  CHECK_FALSE(registry.Receive(state));  // it is on its way
  // What the robot reports of a stop by another program can be resumed.
  state.stopped = true;
  state.stop_revision = 20;
  registry.Receive(state);
  CHECK(registry.Resume("ben", {{"r1"}}, {9}).value().at(0).revision == 21);
}

TEST_CASE("The next order counts for the robot, whatever the revisions so far",
          "[operator][control][stop]") {
  constexpr std::uint64_t kLast = ~std::uint64_t{0};
  struct Row {
    std::uint64_t ours, reported, next;
  };
  for (const Row& row :
       {Row{0, 0, 1}, Row{5, 0, 6}, Row{5, 9, 10}, Row{kMaxCounterStep - 1, 0, kMaxCounterStep},
        Row{kMaxCounterStep, 0, 1},  // the robot's driver has restarted
        Row{kLast, 5, 6}, Row{5, kLast, kLast}}) {
    CAPTURE(row.ours, row.reported);
    ControlRegistry one(kRobots, {});
    one.Adopt(StopOrder{{}, "w1", "r1", row.ours, true, "anna", ""});
    one.Receive({.world = "w1", .robot = "r1", .stopped = true, .stop_revision = row.reported});
    CHECK(one.Stop("anna", {{"r1"}, ""}, {})->front().revision == row.next);
    CHECK(one.Resume("anna", {{"r1"}}, {})->front().revision == row.next);
    const auto again = one.Receive({.world = "w1", .robot = "r1", .stop_revision = row.reported});
    const bool on_its_way = row.ours >= row.reported && row.next == row.ours + 1;
    CHECK(again.has_value() == !on_its_way);
    if (again) CHECK(again->revision == row.next);
  }
}

TEST_CASE_METHOD(ControlBench,
                 "Anybody may stop robots under any control, orders count once they are adopted",
                 "[operator][control]") {
  REQUIRE(registry.Take("anna", {{}, ""}, now));
  const auto orders = registry.Stop("ben", {{}, "fire"}, {5});
  REQUIRE(orders);
  REQUIRE(orders->size() == 3);
  CHECK((*orders)[2] == StopOrder{{5}, "w2", "r3", 1, true, "ben", "fire"});
  CHECK_FALSE(registry.robots().at("r3").stop.stopped);
  for (const StopOrder& order : *orders) registry.Adopt(order);
  CHECK(registry.robots().at("r3").stop.stopped);
  CHECK(registry.Stop("ben", {{"r3"}, ""}, {6})->front().revision == 2);  // sent once more
  const auto resumed = registry.Resume("anna", {{"r3"}}, {7});
  REQUIRE(resumed->size() == 1);
  CHECK(resumed->front().revision == 2);
  CHECK_FALSE(resumed->front().stopped);
}

TEST_CASE_METHOD(ControlBench, "A robot that is not known is refused by name",
                 "[operator][control]") {
  CHECK(registry.Stop("ben", {{"r1", "r9"}, ""}, {}).error().text.find("r9") != std::string::npos);
  CHECK_FALSE(registry.Take("ben", {{"r9"}, ""}, now));
  CHECK_FALSE(registry.Release("ben", {{"r9"}}, now));
}

TEST_CASE("Robots may stand from the start until somebody lets them go", "[operator][control]") {
  const ControlRegistry registry(kRobots, ControlOptions{60.0, true});
  CHECK(registry.robots().at("r1").stop.stopped);
  CHECK(registry.robots().at("r1").stop.revision == 1);
  CHECK(registry.Resume("anna", {{"r1"}}, {})->front().revision == 2);
}

TEST_CASE_METHOD(ControlBench, "The version rises with every change", "[operator][control]") {
  std::uint64_t last = registry.version();
  const auto changed = [&] { return std::exchange(last, registry.version()) != last; };
  REQUIRE(registry.Take("anna", {{"r1"}, ""}, now));
  CHECK(changed());
  registry.Renew("ben", now);
  CHECK_FALSE(changed());
  registry.Expire(now + 61s);
  CHECK(changed());
  registry.Expire(now + 62s);
  CHECK_FALSE(changed());
  registry.Adopt({{}, "w1", "r1", 1, true, "ben", ""});
  CHECK(changed());
}

// The faults report's S4: the name of a page is public, and was believed of any program.
TEST_CASE("a client's name belongs to the first program that uses it", "[operator][control]") {
  ClientNames names;
  const Clock::TimePoint now{};
  const ClientNames::Writer anna{1};
  const ClientNames::Writer rogue{2};
  CHECK(names.Claim("anna", anna, now).empty());
  CHECK(names.Claim("anna", anna, now + 1s).empty());
  CHECK_THAT(names.Claim("anna", rogue, now + 2s), Catch::Contains("anna"));
  CHECK(names.Claim("anna", anna, now + ClientNames::kKept).empty());
  // A day after its last use it is free.
  CHECK(names.Claim("anna", rogue, now + 2 * ClientNames::kKept).empty());

  names.ClaimOwn("ben/page", now);
  CHECK_FALSE(names.Claim("ben/page", rogue, now).empty());
  names.ClaimOwn("anna", now + 2 * ClientNames::kKept);
  CHECK_FALSE(names.Claim("anna", rogue, now + 2 * ClientNames::kKept).empty());
}

TEST_CASE("one program cannot use up the names", "[operator][control]") {
  ClientNames names;
  const Clock::TimePoint now{};
  const auto claim = [&](std::size_t i, const ClientNames::Writer& writer) {
    return names.Claim("name" + std::to_string(i), writer, now).empty();
  };
  for (std::size_t i = 0; i < ClientNames::kMostOfWriter; ++i) REQUIRE(claim(i, {1}));
  CHECK_FALSE(claim(1000, {1}));
  CHECK(claim(1000, {2}));
  CHECK(claim(0, {1}));
}

}  // namespace
}  // namespace conav::operators
