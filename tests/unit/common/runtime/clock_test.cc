#include "common/runtime/clock.h"

#include <catch2/catch.hpp>

namespace conav {
namespace {

using namespace std::chrono_literals;

TEST_CASE("simulation time converts to seconds and back without a rest", "[runtime][clock]") {
  CHECK(SimTime::FromSeconds(1.25).nanoseconds == 1'250'000'000);
  CHECK(SimTime::FromSeconds(0.1).nanoseconds == 100'000'000);
  CHECK(SimTime::FromSeconds(-0.5).nanoseconds == -500'000'000);
  CHECK(SimTime{2'500'000'000}.ToSeconds() == 2.5);
}

TEST_CASE("simulation times add and compare", "[runtime][clock]") {
  const SimTime start = SimTime::FromSeconds(3.0);
  CHECK(start + 250ms == SimTime::FromSeconds(3.25));
  CHECK(start < start + 1ns);
}

TEST_CASE("a fake clock moves only when told", "[runtime][clock]") {
  FakeClock clock;
  const auto start = clock.Now();
  CHECK(clock.Now() == start);
  clock.Advance(5s);
  CHECK(clock.Now() - start == 5s);
}

TEST_CASE("the steady clock does not go back", "[runtime][clock]") {
  const SteadyClock clock;
  const auto start = clock.Now();
  CHECK(clock.Now() >= start);
}

}  // namespace
}  // namespace conav
