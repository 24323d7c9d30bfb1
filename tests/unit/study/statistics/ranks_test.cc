#include <catch2/catch.hpp>

#include "study/statistics/moments.h"

namespace conav::statistics {
namespace {

using Values = std::vector<double>;

TEST_CASE("Equal values share the mean of their ranks", "[operator][statistics]") {
  const Ranks ranks = RankValues(Values{5, 1, 5, 2, 5, 1}, 0.0);
  CHECK(ranks.ranks == Values{5, 1.5, 5, 3, 5, 1.5});
  CHECK(ranks.tie_sum == 24.0 + 6.0);
}

TEST_CASE("Values apart by rounding errors only are equal", "[operator][statistics]") {
  const Ranks ranks = RankValues(Values{0.3 - 0.2, 0.2 - 0.1, 0.5}, 1e-15);
  CHECK(ranks.ranks == Values{1.5, 1.5, 3});
}

TEST_CASE("No values have no ranks", "[operator][statistics]") {
  CHECK(RankValues(Values{}, 0.0).ranks.empty());
}

}  // namespace
}  // namespace conav::statistics
