#include "common/runtime/log.h"

#include <catch2/catch.hpp>

namespace conav {
namespace {

using namespace std::chrono_literals;

TEST_CASE("a log limit allows the first line and then one per period", "[log]") {
  LogLimit limit(1s);
  const LogLimit::TimePoint start{};
  CHECK(limit.Allow(start) == 0U);
  CHECK_FALSE(limit.Allow(start));
  CHECK_FALSE(limit.Allow(start + 999ms));
  CHECK(limit.Allow(start + 1s) == 2U);
  CHECK_FALSE(limit.Allow(start + 1s));
  CHECK(limit.Allow(start + 10s) == 1U);
  CHECK(limit.Allow(start + 11s) == 0U);
}

}  // namespace
}  // namespace conav
