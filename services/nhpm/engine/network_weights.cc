#include "nhpm/engine/network_weights.h"

#include <cmath>
#include <numbers>

#include "common/runtime/random.h"

namespace conav::nhpm {
namespace {

/// Standard normal draws by Box and Muller.
double Normal(Random& random) {
  const double radius = std::sqrt(-2.0 * std::log(1.0 - random.Unit()));
  return radius * std::cos(2.0 * std::numbers::pi * random.Unit());
}

}  // namespace

NetworkWeights ZeroWeights(NetworkShape shape) {
  NetworkWeights result{shape, {}, {}};
  for (int layer = 0; layer < shape.layers(); ++layer) {
    result.weights.emplace_back(shape.WeightsOf(layer), 0.0F);
    result.biases.emplace_back(static_cast<std::size_t>(shape.OutputsOf(layer)), 0.0F);
  }
  return result;
}

NetworkWeights InitialWeights(NetworkShape shape, std::uint64_t seed, float output_bias) {
  NetworkWeights result = ZeroWeights(shape);
  Random random(seed);
  for (int layer = 0; layer < shape.layers(); ++layer) {
    const double deviation = std::sqrt(2.0 / (9.0 * shape.InputsOf(layer)));
    for (float& value : result.weights[static_cast<std::size_t>(layer)]) {
      value = static_cast<float>(deviation * Normal(random));
    }
  }
  for (float& value : result.biases.back()) value = output_bias;
  return result;
}

}  // namespace conav::nhpm
