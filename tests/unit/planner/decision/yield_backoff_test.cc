#include <algorithm>
#include <catch2/catch.hpp>
#include <set>

#include "planner/decision/robot_worker.h"

namespace conav::planner {
namespace {

using namespace std::chrono_literals;

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

TEST_CASE("who makes room once goes on at once, who keeps making room waits longer and longer",
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

TEST_CASE("a robot that gets on begins anew", "[planner][traffic]") {
  YieldBackoff backoff(1, kSlot);
  for (int i = 0; i < 4; ++i) backoff.MakesRoom(kNow);
  for (int i = 0; i < YieldBackoff::kOwnMoves; ++i) backoff.Moves();
  backoff.MakesRoom(kNow + 10s);
  CHECK(backoff.until() == kNow + 10s);
}

}  // namespace
}  // namespace conav::planner
