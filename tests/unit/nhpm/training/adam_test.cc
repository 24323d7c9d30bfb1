#include <catch2/catch.hpp>

#include "nhpm/training/trainer.h"

namespace conav::nhpm {
namespace {

constexpr NetworkShape kShape{16};

TEST_CASE("Adam's first step has the length of the learning rate, against the gradient",
          "[nhpm][training]") {
  NetworkWeights weights = ZeroWeights(kShape);
  NetworkWeights gradient = ZeroWeights(kShape);
  gradient.weights[1][7] = 0.5F;
  gradient.biases[3][1] = -1e-3F;
  AdamState state = InitialAdamState(kShape);
  AdamStep({.learning_rate = 0.01F}, gradient, state, weights);
  CHECK(state.steps == 1);
  CHECK(weights.weights[1][7] == Approx(-0.01).epsilon(1e-4));
  CHECK(weights.biases[3][1] == Approx(0.01).epsilon(1e-4));
  CHECK(weights.weights[1][8] == 0.0F);
}

TEST_CASE("Adam's second step weighs both gradients", "[nhpm][training]") {
  NetworkWeights weights = ZeroWeights(kShape);
  NetworkWeights gradient = ZeroWeights(kShape);
  AdamState state = InitialAdamState(kShape);
  gradient.biases[0][0] = 1.0F;
  AdamStep({.learning_rate = 0.01F}, gradient, state, weights);
  gradient.biases[0][0] = 3.0F;
  AdamStep({.learning_rate = 0.01F}, gradient, state, weights);
  // m = (0.09 + 0.3) / 0.19, v = (0.000999 + 0.009) / 0.001999
  CHECK(weights.biases[0][0] == Approx(-0.01 - 0.01 * 2.0526316 / 2.2365131).epsilon(1e-4));
}

TEST_CASE("Layers below the first one to learn stay as they are", "[nhpm][training]") {
  NetworkWeights weights = InitialWeights(kShape, 1);
  const NetworkWeights before = weights;
  const NetworkWeights gradient = InitialWeights(kShape, 2);
  AdamState state = InitialAdamState(kShape);
  AdamStep({}, gradient, state, weights, 2);
  CHECK((weights.weights[1] == before.weights[1]));
  CHECK((weights.biases[1] == before.biases[1]));
  CHECK_FALSE((weights.weights[2] == before.weights[2]));
  CHECK_FALSE((weights.biases[3] == before.biases[3]));
}

}  // namespace
}  // namespace conav::nhpm
