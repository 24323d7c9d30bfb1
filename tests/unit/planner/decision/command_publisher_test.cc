#include <algorithm>
#include <catch2/catch.hpp>
#include <set>

#include "planner/decision/robot_worker.h"

using namespace conav;
using namespace conav::planner;
using namespace std::chrono_literals;

TEST_CASE("the first command takes the lease one epoch above the robot's, the next keep it",
          "[planner][command]") {
  CommandPublisher publisher("r1", 5s);
  const RobotState state{.command_sequence_number = 41, .lease_epoch = 6};
  const RobotCommand first = publisher.Issue({CommandKind::kMove, {2, 3}, 0.0}, state, {1000});
  CHECK(first.lease_epoch == 7);
  CHECK(first.sequence_number == 42);
  CHECK(first.expires_at == SimTime{1000} + 5s);
  CHECK(first.target == Cell{2, 3});
  CHECK(first.robot == "r1");
  const auto second = publisher.Issue({CommandKind::kTransmitView, {}, 1.5}, state, {});
  CHECK(second.sequence_number == 43);
  CHECK(second.lease_epoch == 7);
  CHECK(second.heading_rad == 1.5);
}

TEST_CASE("only a command that was not taken up is repeated, with a fresh expiry",
          "[planner][command]") {
  CommandPublisher publisher("r1", 5s);
  RobotState state;
  CHECK_FALSE(publisher.Repeat(state, {}).has_value());
  const auto command = publisher.Issue({}, state, {});
  const auto repeat = publisher.Repeat(state, SimTime{} + 7s);
  REQUIRE(repeat.has_value());
  CHECK(repeat->sequence_number == command.sequence_number);
  CHECK(repeat->expires_at == SimTime{} + 12s);
  state.command_sequence_number = command.sequence_number;
  CHECK(publisher.Repeat(state, {}).has_value());  // another planner's
  state.lease_epoch = command.lease_epoch;
  CHECK_FALSE(publisher.Repeat(state, {}).has_value());
}

namespace {

constexpr Clock::TimePoint kNow{1s};
constexpr std::chrono::milliseconds kSlot{100};

/// The longest of many waits after the robot made room `times` times.
std::chrono::nanoseconds LongestWait(int times) {
  std::chrono::nanoseconds longest{0};
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    YieldBackoff backoff(seed, kSlot);
    for (int i = 0; i < times; ++i) backoff.MakesRoom(kNow);
    longest = std::max(longest, backoff.until() - kNow);
  }
  return longest;
}

}  // namespace

TEST_CASE("a robot that makes room once goes on at once, then it waits longer and longer",
          "[planner][traffic]") {
  CHECK(LongestWait(1) == 0 * kSlot);
  CHECK(LongestWait(2) == 2 * kSlot);
  CHECK(LongestWait(3) == 6 * kSlot);
  CHECK(LongestWait(4) == 14 * kSlot);
  CHECK(LongestWait(50) == 14 * kSlot);
}

TEST_CASE("two robots wait for different times", "[planner][traffic]") {
  std::set<std::chrono::nanoseconds> waits;
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    YieldBackoff backoff(seed, kSlot);
    for (int i = 0; i < 4; ++i) backoff.MakesRoom(kNow);
    waits.insert(backoff.until() - kNow);
  }
  CHECK(waits.size() > 10);
}

TEST_CASE("a robot that moves on starts again with the shortest wait", "[planner][traffic]") {
  YieldBackoff backoff(1, kSlot);
  for (int i = 0; i < 4; ++i) backoff.MakesRoom(kNow);
  for (int i = 0; i < YieldBackoff::kOwnMoves; ++i) backoff.Moves();
  backoff.MakesRoom(kNow + 10s);
  CHECK(backoff.until() == kNow + 10s);
}
