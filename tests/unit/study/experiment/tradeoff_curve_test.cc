#include <catch2/catch.hpp>

#include "study/experiment/tradeoff.h"

namespace conav::planner {
namespace {

/// Few pictures cost moves; more than four help no more.
TradeoffCurve Falling() { return TradeoffCurve({{8, 30}, {2, 40}, {4, 30}}); }

TEST_CASE("between its points the curve is straight", "[planner][experiment]") {
  CHECK(Falling().EffortAt(2) == 40.0);
  CHECK(Falling().EffortAt(3) == Approx(35.0));
  CHECK(Falling().EffortAt(6) == Approx(30.0));
  CHECK(Falling().PicturesAt(37.5) == Approx(2.5));
}

TEST_CASE("beyond its ends the curve gives what it has or nothing", "[planner][experiment]") {
  CHECK_FALSE(Falling().EffortAt(1.9));
  CHECK(Falling().EffortAt(100) == 30.0);
  CHECK(Falling().PicturesAt(50) == 2.0);
  CHECK_FALSE(Falling().PicturesAt(29.9));
}

TEST_CASE("more pictures need not be used: the least effort counts where the curve comes back",
          "[planner][experiment]") {
  const TradeoffCurve curve({{1, 40}, {3, 20}, {5, 30}, {7, 10}});
  CHECK(curve.EffortAt(4) == 20.0);
  CHECK(curve.EffortAt(6.5) == Approx(15.0));
  CHECK(curve.EffortAt(9) == 10.0);
}

TEST_CASE("the fewest pictures count where the curve comes back", "[planner][experiment]") {
  const TradeoffCurve curve({{1, 40}, {3, 20}, {5, 30}, {7, 10}});
  CHECK(curve.PicturesAt(25) == Approx(2.5));
  CHECK(curve.PicturesAt(15) == Approx(6.5));
}

TEST_CASE("a curve of one point, or of equal ones", "[planner][experiment]") {
  CHECK(TradeoffCurve({{2, 40}}).EffortAt(2) == 40.0);
  CHECK(TradeoffCurve({{2, 40}, {2, 40}}).EffortAt(2) == 40.0);
  CHECK_FALSE(TradeoffCurve({{2, 40}}).PicturesAt(39));
}

}  // namespace
}  // namespace conav::planner
