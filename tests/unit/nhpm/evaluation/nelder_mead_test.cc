#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

#include "nhpm/evaluation/glpf_fit.h"

namespace conav::nhpm {
namespace {

double Rosenbrock(std::span<const double> at) {
  double sum = 0.0;
  for (std::size_t i = 0; i + 1 < at.size(); ++i) {
    const double valley = at[i + 1] - at[i] * at[i];
    sum += 100.0 * valley * valley + (1.0 - at[i]) * (1.0 - at[i]);
  }
  return sum;
}

TEST_CASE("The minimum of Rosenbrock's function is found from its classic start",
          "[nhpm][nelder_mead]") {
  const auto found = MinimiseNelderMead(Rosenbrock, std::vector{-1.2, 1.0});
  CHECK(found.converged);
  CHECK(found.position[0] == Approx(1.0).margin(1e-4));
  CHECK(found.position[1] == Approx(1.0).margin(1e-4));
  CHECK(found.value < 1e-9);
}

TEST_CASE("Four coordinates work as well", "[nhpm][nelder_mead]") {
  const auto found = MinimiseNelderMead(Rosenbrock, std::vector{0.5, 0.5, 0.5, 0.5},
                                        {.iterations = 10000, .tolerance = 1e-14});
  for (const double coordinate : found.position) CHECK(coordinate == Approx(1.0).margin(1e-4));
}

TEST_CASE("A parabola of one coordinate has its minimum where it is", "[nhpm][nelder_mead]") {
  const auto parabola = [](std::span<const double> at) {
    return (at[0] - 3.0) * (at[0] - 3.0) + 2;
  };
  const auto found = MinimiseNelderMead(parabola, std::vector{-10.0});
  CHECK(found.position[0] == Approx(3.0).margin(1e-4));
  CHECK(found.value == Approx(2.0));
}

TEST_CASE("Equal values far from each other are no minimum yet", "[nhpm][nelder_mead]") {
  const auto flat = [](std::span<const double>) { return 1.0; };
  CHECK_FALSE(MinimiseNelderMead(flat, std::vector{0.0, 0.0}, {.iterations = 10}).converged);
  CHECK(MinimiseNelderMead(flat, std::vector{0.0, 0.0}).converged);
}

TEST_CASE("Values that are no numbers are walked around", "[nhpm][nelder_mead]") {
  const auto logarithm = [](std::span<const double> at) {
    return at[0] <= 0.0 ? std::numeric_limits<double>::quiet_NaN() : at[0] - std::log(at[0]);
  };
  CHECK(MinimiseNelderMead(logarithm, std::vector{0.1}).position[0] == Approx(1.0).margin(1e-4));
}

TEST_CASE("The search ends when its iterations are spent", "[nhpm][nelder_mead]") {
  const auto found = MinimiseNelderMead(Rosenbrock, std::vector{-1.2, 1.0}, {.iterations = 5});
  CHECK(found.iterations == 5);
  CHECK_FALSE(found.converged);
  CHECK(found.value < Rosenbrock(std::vector{-1.2, 1.0}));
}

}  // namespace
}  // namespace conav::nhpm
