#include "common/plot/axes.h"

#include <catch2/catch.hpp>

namespace conav {
namespace {

using Values = std::vector<double>;

TEST_CASE("ticks are round, lie around the values and within the limits", "[svg]") {
  CHECK(RoundAxis(0.0, 74.7, 4).Ticks() == Values{0.0, 20.0, 40.0, 60.0, 80.0});
  CHECK(RoundAxis(-3.0, 12.0, 4).Ticks() == Values{-5.0, 0.0, 5.0, 10.0, 15.0});
  const Axis small = RoundAxis(0.0, 1.3e-6, 5);
  CHECK(small.high == Approx(1.5e-6));
  CHECK(small.step == Approx(5e-7));
  const AxisLimits share{0.0, 1.0};
  CHECK(RoundAxis(-0.4, 1.6, 5, share).Ticks().back() == 1.0);
  CHECK(RoundAxis(-0.4, 1.6, 5, share).low == 0.0);
  CHECK(RoundAxis(-20.0, 70.0, 6, {.least = 0.0}).low == 0.0);
  const Axis cut = RoundAxis(0.0, 20.0, 4, {0.0, 16.0});
  CHECK(cut.high == 16.0);
  CHECK(cut.Ticks() == Values{0.0, 5.0, 10.0, 15.0});
  const AxisLimits limits{0.0, 1.0};
  for (const double value : {0.0, 0.3, 1.0}) {
    const Axis axis = RoundAxis(value, value, 5, limits);
    CAPTURE(value, axis.low, axis.high);
    CHECK(axis.high > axis.low);
    CHECK((axis.low >= 0.0 && axis.high <= 1.0 && axis.Has(value)));
  }
  CHECK(RoundAxis(0.0, 0.0, 5).low < 0.0);
  const Axis axis{.low = 10.0, .high = 20.0, .step = 5.0};
  CHECK(axis.Share(15.0) == 0.5);
  CHECK(axis.Clamp(25.0) == 20.0);
  CHECK(axis.Clamp(5.0) == 10.0);
  CHECK((axis.Has(20.0) && !axis.Has(20.1) && !axis.Has(9.9)));
}

TEST_CASE("other scales have round ticks, too, and what lies outside is drawn at the end",
          "[svg]") {
  const Axis counts{.low = 0.0, .high = 12.0, .scale = Scale::kSquareRoot};
  CHECK(counts.Ticks() == Values{0.0, 1.0, 2.0, 5.0, 10.0});
  const Axis powers{.low = 0.4, .high = 40.0, .scale = Scale::kLogarithmic};
  CHECK(powers.Ticks() == Values{0.5, 1.0, 2.0, 5.0, 10.0, 20.0});
  CHECK(powers.Share(4.0) == Approx(0.5));
  const PixelPosition at = PlotArea{{10.0, 20.0}, 100.0, 50.0, counts, powers}.At(3.0, 400.0);
  CHECK((at.x == Approx(60.0) && at.y == Approx(20.0)));
}

}  // namespace
}  // namespace conav
