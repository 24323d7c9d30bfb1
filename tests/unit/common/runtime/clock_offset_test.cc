#include "common/runtime/clock_offset.h"

#include <catch2/catch.hpp>
#include <limits>

namespace conav {
namespace {

// A clock that is `ahead_s`; the question takes `there_s`, the answer `back_s`, and 0.3 s pass between them.
bool Ask(ClockOffset& clock, double at_s, double ahead_s, double there_s, double back_s) {
  const double received_s = at_s + there_s;
  const double sent_s = received_s + 0.3;
  return clock.Add(at_s, received_s + ahead_s, sent_s + ahead_s, sent_s + back_s);
}

TEST_CASE("a clock's offset is that of the quickest answer, within half of its round trip",
          "[service][clock]") {
  ClockOffset clock;
  CHECK_FALSE(clock.best());
  const double ahead_s = GENERATE(-2.0, -0.5, 0.0, 0.5, 3600.0);
  CHECK(Ask(clock, 10.0, ahead_s, 0.4, 0.0));
  CHECK(clock.best()->round_trip_s == Approx(0.4));
  CHECK(clock.best()->offset_s == Approx(ahead_s + 0.2));
  CHECK(Ask(clock, 12.0, ahead_s, 0.01, 0.01));
  CHECK(Ask(clock, 14.0, ahead_s, 0.0, 0.2));
  CHECK(clock.best()->round_trip_s == Approx(0.02));
  CHECK(clock.best()->offset_s == Approx(ahead_s).margin(1e-9));
}

TEST_CASE("after a clock was set, only answers since then count", "[service][clock]") {
  ClockOffset clock;
  Ask(clock, 10.0, 0.0, 0.001, 0.001);
  Ask(clock, 12.0, -2.0, 0.05, 0.05);
  CHECK(clock.best()->offset_s == Approx(-2.0));
  for (std::size_t i = 0; i < ClockOffset::kWindow; ++i) {
    Ask(clock, 14.0 + static_cast<double>(i), -2.0, 0.1, 0.1);
  }
  CHECK(clock.best()->round_trip_s == Approx(0.2));  // the quickest has left the window
}

TEST_CASE("an answer that no clocks allow does not count", "[service][clock]") {
  ClockOffset clock;
  CHECK_FALSE(clock.Add(10.0, 20.0, 21.0, 10.5));  // answered before it came
  CHECK_FALSE(clock.Add(10.0, 21.0, 20.0, 11.0));
  CHECK_FALSE(clock.Add(10.0, std::numeric_limits<double>::quiet_NaN(), 20.0, 11.0));
  CHECK_FALSE(clock.best());
}

}  // namespace
}  // namespace conav
