#include <catch2/catch.hpp>

#include "planner/explain/explanation.h"

namespace conav::planner {
namespace {

TEST_CASE("a decision or a range of them is read", "[planner][explain]") {
  const auto one = ParseDecisionRange("12");
  REQUIRE(one);
  CHECK(one->is_one());
  CHECK(one->Contains(12));
  CHECK_FALSE(one->Contains(11));
  const auto several = ParseDecisionRange("12..20");
  REQUIRE(several);
  CHECK_FALSE(several->is_one());
  CHECK(several->Contains(12));
  CHECK(several->Contains(20));
  CHECK_FALSE(several->Contains(21));
}

TEST_CASE("anything else is refused", "[planner][explain]") {
  const char* text = GENERATE("", "0", "-1", "x", "3x", "20..12", "1..", "..2", "1...2", "1-2",
                              "99999999999999999999");
  const auto range = ParseDecisionRange(text);
  REQUIRE_FALSE(range);
  CHECK_THAT(range.error().text, Catch::Contains(text));
}

}  // namespace
}  // namespace conav::planner
