#include <catch2/catch.hpp>
#include <cmath>

#include "operator/belief/belief_store.h"
#include "unit/operator/support/drawn_map.h"

namespace conav::operators {
namespace {

Belief Current() { return {{5}, "w1", 3, DrawnMap({"####", "#  #", "#? #", "####"}), "somebody"}; }

std::string EditRefusal(const EditRequest& request) {
  const auto edited = ApplyEdit(Current(), request, "c", {});
  return edited ? "" : edited.error().text;
}

std::string GuideRefusal(const GuideRequest& request, const GuidanceLimits& limits = {}) {
  const auto guidance = MakeGuidance(Current(), request, 0, "c", {}, limits);
  return guidance ? "" : guidance.error().text;
}

TEST_CASE("An edit sets its cells, counts the revision up and names its author",
          "[operator][belief]") {
  const auto edited = ApplyEdit(Current(), {3, {{{1, 1}, true}, {{2, 1}, false}}}, "anna", {9});
  REQUIRE(edited);
  CHECK(edited->wall_probability == DrawnMap({"####", "## #", "#  #", "####"}));
  CHECK(edited->revision == 4);
  CHECK(edited->edited_by == "anna");
  CHECK(edited->stamp == SimTime{9});
  CHECK(edited->world == "w1");
}

TEST_CASE("An edit of nothing is refused", "[operator][belief]") {
  CHECK(EditRefusal({3, {}}) == "the edit names no cell");
}

TEST_CASE("An edit outside of the map or on its border is refused", "[operator][belief]") {
  CHECK(EditRefusal({3, {{{4, 1}, true}}}) == "cell (4,1) lies outside of the map of 4 x 4 cells");
  CHECK(EditRefusal({3, {{{-1, 1}, true}}}).find("outside") != std::string::npos);
  CHECK(EditRefusal({3, {{{1, 1}, true}, {{3, 1}, false}}}) ==
        "cell (3,1) is on the border of the map of 4 x 4 cells, which cannot be edited");
}

TEST_CASE("A cell edited twice in one request is refused", "[operator][belief]") {
  CHECK(EditRefusal({3, {{{1, 1}, true}, {{1, 1}, false}}}).find("twice") != std::string::npos);
}

TEST_CASE("An edit based on another revision is refused with both revisions",
          "[operator][belief]") {
  CHECK(EditRefusal({2, {{{1, 1}, true}}}) ==
        "the edit is based on revision 2 of world w1; the current one is 3");
  CHECK_FALSE(EditRefusal({4, {{{1, 1}, true}}}).empty());
}

TEST_CASE("Guidance carries the belief that it was drawn on and how long it holds",
          "[operator][belief]") {
  const GuideRequest request{"r1", {{1, 1}, {1, 2}, {2, 2}}, 7, 2.5};
  const auto guidance = MakeGuidance(Current(), request, 4, "anna", {1'000'000'000}, {});
  REQUIRE(guidance);
  CHECK(
      *guidance ==
      Guidance{
          {1'000'000'000}, "w1", "r1", 5, {{1, 1}, {1, 2}, {2, 2}}, "anna", 3, 7, {3'500'000'000}});
}

TEST_CASE("An empty path withdraws guidance and is accepted", "[operator][belief]") {
  CHECK(GuideRefusal({"r1", {}, 0, 1.0}).empty());
}

TEST_CASE("A path with a jump, a diagonal or a repeated cell is refused", "[operator][belief]") {
  CHECK(GuideRefusal({"r1", {{1, 1}, {2, 2}}, 0, 1.0}) ==
        "path cells (1,1) and (2,2) (index 1) are not 4-neighbours");
  CHECK_FALSE(GuideRefusal({"r1", {{1, 1}, {1, 1}}, 0, 1.0}).empty());
}

TEST_CASE("A path that leaves the map is refused", "[operator][belief]") {
  CHECK(GuideRefusal({"r1", {{3, 1}, {4, 1}}, 0, 1.0}) ==
        "path cell (4,1) (index 1) lies outside of the map of 4 x 4 cells");
}

TEST_CASE("A path over the limit is refused", "[operator][belief]") {
  const GuidanceLimits limits{10.0, 2};
  CHECK(GuideRefusal({"r1", {{1, 1}, {1, 2}}, 0, 1.0}, limits).empty());
  CHECK(GuideRefusal({"r1", {{1, 1}, {1, 2}, {1, 1}}, 0, 1.0}, limits) ==
        "the path has 3 cells; the limit is 2");
}

TEST_CASE("Guidance holds for a time above zero and up to the limit", "[operator][belief]") {
  const GuidanceLimits limits{10.0, 100};
  CHECK(GuideRefusal({"r1", {}, 0, 10.0}, limits).empty());
  for (const double valid_for_s : {0.0, -1.0, 10.1, std::nan(""), HUGE_VAL}) {
    CAPTURE(valid_for_s);
    CHECK(GuideRefusal({"r1", {}, 0, valid_for_s}, limits).find("(0, 10]") != std::string::npos);
  }
}

}  // namespace
}  // namespace conav::operators
