#include <catch2/catch.hpp>

#include "common/bus/intake.h"

namespace conav::bus {
namespace {

const Guid kFirst = {1};
const Guid kSecond = {2};

TEST_CASE("a stamp is new once per writer", "[bus][deduplicator]") {
  Deduplicator seen;
  CHECK(seen.IsNew(kFirst, 10));
  CHECK_FALSE(seen.IsNew(kFirst, 10));
  CHECK(seen.IsNew(kSecond, 10));
  CHECK_FALSE(seen.IsNew(kFirst, 10));
}

TEST_CASE("a whole repeated history is recognised, and what follows is new",
          "[bus][deduplicator]") {
  Deduplicator seen;
  constexpr auto kHistory = static_cast<std::int64_t>(Deduplicator::kWindow);
  for (std::int64_t stamp = 0; stamp < 3 * kHistory; ++stamp) REQUIRE(seen.IsNew(kFirst, stamp));
  for (std::int64_t stamp = 2 * kHistory; stamp < 3 * kHistory; ++stamp) {
    REQUIRE_FALSE(seen.IsNew(kFirst, stamp));
  }
  CHECK(seen.IsNew(kFirst, 3 * kHistory));
}

TEST_CASE("stamps of a clock that was set back are new", "[bus][deduplicator]") {
  Deduplicator seen;
  for (std::int64_t stamp = 1000; stamp < 3000; ++stamp) REQUIRE(seen.IsNew(kFirst, stamp));
  CHECK(seen.IsNew(kFirst, 500));
  CHECK_FALSE(seen.IsNew(kFirst, 500));
}

TEST_CASE("the writer unused for longest is forgotten when there are too many",
          "[bus][deduplicator]") {
  Deduplicator seen;
  CHECK(seen.IsNew(kFirst, 1));
  for (std::size_t i = 0; i < Deduplicator::kWriters; ++i) {
    const Guid writer = {7, static_cast<std::uint8_t>(i), static_cast<std::uint8_t>(i >> 8)};
    REQUIRE(seen.IsNew(writer, 1));
    if (i == 3) CHECK_FALSE(seen.IsNew(kFirst, 1));
  }
  CHECK(seen.IsNew({7, 0, 0}, 1));
}

}  // namespace
}  // namespace conav::bus
