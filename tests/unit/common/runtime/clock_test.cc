#include "common/runtime/clock.h"

#include <catch2/catch.hpp>

namespace conav {
namespace {

using namespace std::chrono_literals;

TEST_CASE("simulation time converts to seconds and back without a rest, adds and compares",
          "[clock]") {
  CHECK(SimTime::FromSeconds(1.25).nanoseconds == 1'250'000'000);
  CHECK(SimTime::FromSeconds(0.1).nanoseconds == 100'000'000);
  CHECK(SimTime::FromSeconds(-0.5).nanoseconds == -500'000'000);
  CHECK(SimTime{2'500'000'000}.ToSeconds() == 2.5);
  const SimTime start = SimTime::FromSeconds(3.0);
  CHECK(start + 250ms == SimTime::FromSeconds(3.25));
  CHECK(start < start + 1ns);
}

TEST_CASE("a fake clock moves only when it is moved, the steady clock not back", "[clock]") {
  FakeClock clock;
  const auto start = clock.Now();
  CHECK(clock.Now() == start);
  clock.Advance(5s);
  CHECK(clock.Now() - start == 5s);
  const SteadyClock steady;
  const auto before = steady.Now();
  CHECK(steady.Now() >= before);
}

}  // namespace
}  // namespace conav
