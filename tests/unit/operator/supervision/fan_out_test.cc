#include <catch2/catch.hpp>

#include "operator/supervision/workload.h"

namespace conav::operators {
namespace {

TEST_CASE("Fan-out is neglect over interaction plus one, waits make it smaller",
          "[operator][attention]") {
  CHECK(FanOut(30.0, 10.0) == 4.0);
  CHECK(FanOut(0.0, 10.0) == 1.0);
  CHECK(FanOutWithWaits(30.0, 10.0, 5.0) == 3.0);
  CHECK(FanOut(30.0, 0.0) == 0.0);
}

TEST_CASE("One robot waits for nobody and keeps the operator busy IT of NT + IT",
          "[operator][attention]") {
  const auto one = PredictFiniteSource(1, 30.0, 10.0);
  CHECK(one.idle == Approx(0.75));
  CHECK(one.utilisation == Approx(0.25));
  CHECK(one.time_in_system == Approx(10.0));
  CHECK(one.waiting_time == Approx(0.0).margin(1e-12));
  CHECK(one.attended == Approx(1.0));
}

TEST_CASE("Rounding never makes a waiting time negative", "[operator][attention]") {
  for (int i = 0; i < 1000; ++i) {
    CHECK(PredictFiniteSource(1, 0.7 + 0.31 * i, 6.0 + 0.013 * i).waiting_time >= 0.0);
  }
}

TEST_CASE("Two robots with lambda / mu = 1/2, by hand", "[operator][attention]") {
  // P0 = 1 / (1 + 2 * 1/2 + 2 * 1/4) = 0.4; W = 2 / (0.1 * 0.6) - 20 = 13.333
  const auto two = PredictFiniteSource(2, 20.0, 10.0);
  CHECK(two.idle == Approx(0.4));
  CHECK(two.utilisation == Approx(0.6));
  CHECK(two.time_in_system == Approx(13.0 + 1.0 / 3.0));
  CHECK(two.waiting_time == Approx(10.0 / 3.0));
  CHECK(two.attended == Approx(1.8));  // 2 - 0.06 / s * 3.333 s
}

TEST_CASE("Four robots with lambda = mu, by hand", "[operator][attention]") {
  // P0 = 1 / (1 + 4 + 12 + 24 + 24) = 1/65
  const auto four = PredictFiniteSource(4, 10.0, 10.0);
  CHECK(four.idle == Approx(1.0 / 65.0));
  CHECK(four.time_in_system == Approx(40.0 * 65.0 / 64.0 - 10.0));
}

TEST_CASE("Many robots keep the operator busy and attended robots come to the fan-out",
          "[operator][attention]") {
  const auto many = PredictFiniteSource(400, 30.0, 10.0);
  CHECK(many.utilisation == Approx(1.0));
  CHECK(many.attended == Approx(FanOut(30.0, 10.0)));
  CHECK(PredictFiniteSource(3, 0.0, 10.0).waiting_time == Approx(20.0));
}

TEST_CASE("Without robots or interactions nobody waits", "[operator][attention]") {
  CHECK(PredictFiniteSource(0, 30.0, 10.0).utilisation == 0.0);
  CHECK(PredictFiniteSource(5, 30.0, 0.0).waiting_time == 0.0);
  CHECK(PredictFiniteSource(5, 30.0, 0.0).attended == 5.0);
}

}  // namespace
}  // namespace conav::operators
