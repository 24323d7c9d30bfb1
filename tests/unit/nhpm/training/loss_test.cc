#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

#include "nhpm/training/batch_pass.h"

namespace conav::nhpm {
namespace {

constexpr auto kMasked = OutputLabel::kMasked;
constexpr auto kKept = OutputLabel::kKept;
constexpr auto kEdited = OutputLabel::kEdited;

TEST_CASE("Softplus agrees with the standard library's", "[nhpm][training]") {
  for (double x = -60.0; x <= 60.0; x += 0.37) {
    INFO(x);
    const double expected = std::fmax(x, 0.0) + std::log1p(std::exp(-std::fabs(x)));
    CHECK(Softplus(x) == Approx(expected).epsilon(2e-15));
  }
}

TEST_CASE("Softplus has no overflow and no surprise at the ends", "[nhpm][training]") {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  CHECK(Softplus(0.0) == Approx(std::log(2.0)).epsilon(1e-15));
  CHECK(Softplus(1e300) == 1e300);
  CHECK(Softplus(-1e300) == 0.0);
  CHECK(Softplus(kInfinity) == kInfinity);
  CHECK(Softplus(-kInfinity) == 0.0);
  CHECK(std::isnan(Softplus(std::nan(""))));
}

TEST_CASE("The loss is the mean over all outputs, masked ones at no cost", "[nhpm][training]") {
  const std::array<float, 4> logits{0.0F, 2.0F, 7.0F, -3.0F};
  const std::array<OutputLabel, 4> labels{kKept, kEdited, kMasked, kMasked};
  // (-log(1/2) - log(1 / (1 + e^-2))) / 4
  CHECK(ExampleLoss(logits, labels) == Approx((0.6931471806 + 0.1269280110) / 4.0));
}

TEST_CASE("The gradient is p - y over the number of outputs, 0 where masked", "[nhpm][training]") {
  const std::array<float, 4> logits{0.0F, 0.0F, 7.0F, -3.0F};
  const std::array<OutputLabel, 4> labels{kKept, kEdited, kMasked, kMasked};
  std::array<float, 4> gradient{};
  LossGradient(logits, labels, 2.0F, gradient);
  CHECK(gradient == std::array<float, 4>{0.25F, -0.25F, 0.0F, 0.0F});
}

TEST_CASE("The gradient is the derivative of the loss", "[nhpm][training]") {
  const std::array<OutputLabel, 2> labels{kKept, kEdited};
  for (float logit = -9.0F; logit < 9.0F; logit += 1.7F) {
    const std::array<float, 2> logits{logit, -0.5F * logit};
    std::array<float, 2> gradient{};
    LossGradient(logits, labels, 1.0F, gradient);
    for (std::size_t i = 0; i < 2; ++i) {
      std::array<float, 2> above = logits;
      std::array<float, 2> below = logits;
      above[i] += 0.0078125F;
      below[i] -= 0.0078125F;
      const double slope = (ExampleLoss(above, labels) - ExampleLoss(below, labels)) / 0.015625;
      CHECK(static_cast<double>(gradient[i]) == Approx(slope).epsilon(1e-4));
    }
  }
}

}  // namespace
}  // namespace conav::nhpm
