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

}  // namespace
}  // namespace conav
