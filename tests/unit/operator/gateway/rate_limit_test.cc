#include <catch2/catch.hpp>

#include "operator/gateway/page_feed.h"

namespace conav::operators {
namespace {

using std::chrono::milliseconds;

int AllowedOf(RateLimit& limit, int tries, Clock::TimePoint now) {
  int allowed = 0;
  for (int i = 0; i < tries; ++i) allowed += limit.Allow(now) ? 1 : 0;
  return allowed;
}

}  // namespace

TEST_CASE("a burst is allowed, and then so many per second", "[operator][gateway]") {
  FakeClock clock;
  RateLimit limit(10.0, 5, clock.Now());
  CHECK(AllowedOf(limit, 8, clock.Now()) == 5);
  clock.Advance(milliseconds(250));
  CHECK(AllowedOf(limit, 8, clock.Now()) == 2);
  clock.Advance(milliseconds(50));  // half a message was left
  CHECK(AllowedOf(limit, 8, clock.Now()) == 1);
}

TEST_CASE("who is silent for long saves up one burst", "[operator][gateway]") {
  FakeClock clock;
  RateLimit limit(10.0, 5, clock.Now());
  clock.Advance(std::chrono::hours(1));
  CHECK(AllowedOf(limit, 100, clock.Now()) == 5);
}

}  // namespace conav::operators
