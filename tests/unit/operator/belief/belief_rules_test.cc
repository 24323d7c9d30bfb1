#include <catch2/catch.hpp>
#include <cmath>

#include "operator/belief/belief_store.h"
#include "support/drawn_map.h"

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

TEST_CASE("An edit that cannot be is refused", "[operator][belief]") {
  const auto [request, named] = GENERATE(table<EditRequest, std::string>({
      {{3, {}}, "no cell"},
      {{3, {{{4, 1}, true}}}, "(4,1)"},
      {{3, {{{-1, 1}, true}}}, "(-1,1)"},
      {{3, {{{1, 1}, true}, {{3, 1}, false}}}, "(3,1)"},
      {{3, {{{1, 1}, true}, {{1, 1}, false}}}, "(1,1)"},
      {{2, {{{1, 1}, true}}}, "revision 2"},
      {{4, {{{1, 1}, true}}}, "revision 4"},
  }));
  CHECK_THAT(EditRefusal(request), Catch::Contains(named));
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

TEST_CASE("A path that cannot be gone, or is over a limit, is refused, up to the limits accepted",
          "[operator][belief]") {
  const auto [path, valid_for_s, named] = GENERATE(table<std::vector<Cell>, double, std::string>({
      {{{1, 1}, {2, 2}}, 1.0, "(2,2)"},
      {{{1, 1}, {1, 1}}, 1.0, "(1,1)"},
      {{{3, 1}, {4, 1}}, 1.0, "(4,1)"},
      {{{1, 1}, {1, 2}, {1, 1}}, 1.0, "limit is 2"},
      {{}, 0.0, "(0, 10]"},
      {{}, -1.0, "(0, 10]"},
      {{}, 10.1, "(0, 10]"},
      {{}, std::nan(""), "(0, 10]"},
      {{}, HUGE_VAL, "(0, 10]"},
  }));
  CHECK_THAT(GuideRefusal({"r1", path, 0, valid_for_s}, {10.0, 2}), Catch::Contains(named));
  CHECK(GuideRefusal({"r1", {}, 0, 10.0}, {10.0, 2}).empty());  // withdraws guidance
  CHECK(GuideRefusal({"r1", {{1, 1}, {1, 2}}, 0, 10.0}, {10.0, 2}).empty());
}

}  // namespace
}  // namespace conav::operators
