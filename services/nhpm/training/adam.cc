#include "nhpm/training/adam.h"

#include <cmath>

#include "common/runtime/demand.h"

namespace conav::nhpm {
namespace {

/// base^exponent by squaring: plain operations, so the same bits on every machine.
double Power(double base, std::uint64_t exponent) {
  double result = 1.0;
  for (; exponent > 0; exponent >>= 1) {
    if ((exponent & 1) != 0) result *= base;
    base *= base;
  }
  return result;
}

/// What is the same for all parameters of a step.
struct StepFactors {
  AdamOptions options;
  float rate = 0.0F;               // learning rate / (1 - beta1^steps)
  float second_correction = 0.0F;  // 1 / (1 - beta2^steps)
};

StepFactors FactorsOf(const AdamOptions& options, std::uint64_t steps) {
  const double beta1 = static_cast<double>(options.beta1);
  const double beta2 = static_cast<double>(options.beta2);
  return {
      options,
      static_cast<float>(static_cast<double>(options.learning_rate) / (1.0 - Power(beta1, steps))),
      static_cast<float>(1.0 / (1.0 - Power(beta2, steps)))};
}

void Step(const StepFactors& factors, const std::vector<float>& gradient, std::vector<float>& first,
          std::vector<float>& second, std::vector<float>& values) {
  const AdamOptions& options = factors.options;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const float g = gradient[i];
    first[i] = options.beta1 * first[i] + (1.0F - options.beta1) * g;
    second[i] = options.beta2 * second[i] + (1.0F - options.beta2) * (g * g);
    values[i] -= factors.rate * first[i] /
                 (std::sqrt(second[i] * factors.second_correction) + options.epsilon);
  }
}

}  // namespace

AdamState InitialAdamState(NetworkShape shape) {
  return {ZeroWeights(shape), ZeroWeights(shape), 0};
}

void AdamStep(const AdamOptions& options, const NetworkWeights& gradient, AdamState& state,
              NetworkWeights& weights, int first_layer) {
  DEMAND(gradient.shape == weights.shape && state.first.shape == weights.shape,
         gradient.shape.width, weights.shape.width, state.first.shape.width);
  ++state.steps;
  const StepFactors factors = FactorsOf(options, state.steps);
  for (auto i = static_cast<std::size_t>(first_layer); i < kNetworkLayers; ++i) {
    Step(factors, gradient.weights[i], state.first.weights[i], state.second.weights[i],
         weights.weights[i]);
    Step(factors, gradient.biases[i], state.first.biases[i], state.second.biases[i],
         weights.biases[i]);
  }
}

}  // namespace conav::nhpm
