#include <catch2/catch.hpp>

#include "study/statistics/pairs.h"
#include "unit/study/statistics/reference_tables.h"

namespace conav::statistics {
namespace {

// R's p.adjust of the same five.
TEST_CASE("Adjusted p are monotone, at most 1, and skip tests without p",
          "[operator][statistics]") {
  const auto adjusted = AdjustForMany({0.01, 0.04, 0.03, std::nullopt, 0.02, 0.5});
  const std::vector<double> holm{0.05, 0.09, 0.09, 0.0, 0.08, 0.5};
  const std::vector<double> bonferroni{0.05, 0.2, 0.15, 0.0, 0.1, 1.0};
  const std::vector<double> bh{0.05, 0.05, 0.05, 0.0, 0.05, 0.5};
  for (const std::size_t i : {0, 1, 2, 4, 5}) {
    CHECK(*adjusted[i].holm == Near(holm[i]));
    CHECK(*adjusted[i].bonferroni == Near(bonferroni[i]));
    CHECK(*adjusted[i].bh == Near(bh[i]));
  }
  CHECK_FALSE(adjusted[3].holm);
  CHECK_FALSE(adjusted[3].bonferroni);
  CHECK_FALSE(adjusted[3].bh);
}

TEST_CASE("One test needs no adjustment, and none gives none", "[operator][statistics]") {
  const auto one = AdjustForMany({0.03});
  CHECK(*one[0].holm == 0.03);
  CHECK(*one[0].bonferroni == 0.03);
  CHECK(*one[0].bh == 0.03);
  CHECK(AdjustForMany({}).empty());
}

}  // namespace
}  // namespace conav::statistics
