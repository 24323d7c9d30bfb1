#include "unit/nhpm/training/torch_gradient.h"

#include <catch2/catch.hpp>
#include <cmath>

#include "nhpm/training/batch_pass.h"
#include "unit/nhpm/training/made_up_examples.h"

namespace conav::nhpm {
namespace {

/// ||a - b|| / ||b||.
double RelativeDifference(const std::vector<float>& a, const std::vector<float>& b) {
  double difference = 0.0;
  double norm = 0.0;
  for (std::size_t i = 0; i < b.size(); ++i) {
    difference += std::pow(static_cast<double>(a[i]) - static_cast<double>(b[i]), 2);
    norm += std::pow(static_cast<double>(b[i]), 2);
  }
  return std::sqrt(difference / norm);
}

TEST_CASE("Loss and gradient agree with libtorch's", "[torch]") {
  const int width = GENERATE(16, 32, 64);
  const ExampleSet set = MadeUpExamples(13, 11, 20, 7);
  const NetworkWeights weights = InitialWeights({width}, 8, -2.0F);
  const TorchResult expected = TorchGradient(weights, set);
  std::vector<BatchItem> items;
  for (const Example& example : set.examples) items.push_back({&example, 0});
  NetworkWeights gradient = ZeroWeights({width});
  const double loss =
      BatchPass({width}, 13, 11, 2).Gradient(TrainingWeights(weights), items, gradient);
  CHECK(loss / 20.0 == Approx(expected.loss).epsilon(1e-5));
  for (std::size_t layer = 0; layer < kNetworkLayers; ++layer) {
    INFO("width " << width << " layer " << layer);
    CHECK(RelativeDifference(gradient.weights[layer], expected.gradient.weights[layer]) < 1e-5);
    CHECK(RelativeDifference(gradient.biases[layer], expected.gradient.biases[layer]) < 1e-5);
  }
}

}  // namespace
}  // namespace conav::nhpm
