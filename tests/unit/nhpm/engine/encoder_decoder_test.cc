#include "nhpm/engine/encoder_decoder.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <utility>

#include "common/runtime/random.h"
#include "nhpm/engine/training_pass.h"

namespace conav::nhpm {
namespace {

constexpr NetworkShape kTiny{4, Architecture::kEncoderDecoder};

std::shared_ptr<const NetworkWeights> TinyWeights(std::uint64_t seed) {
  NetworkWeights weights = InitialWeights(kTiny, seed, -0.5F);
  Random random(seed + 1);
  for (auto& biases : weights.biases) {
    for (float& bias : biases) bias += static_cast<float>(0.4 * random.Unit() - 0.1);
  }
  return std::make_shared<const NetworkWeights>(std::move(weights));
}

std::vector<float> RandomValues(std::size_t count, std::uint64_t seed) {
  Random random(seed);
  std::vector<float> values(count);
  for (float& value : values) value = static_cast<float>(random.Unit());
  return values;
}

std::vector<float> InputOfSize(int rows, int columns, std::uint64_t seed) {
  return RandomValues(static_cast<std::size_t>(rows * columns * kInputChannels), seed);
}

TEST_CASE("Sizes halve rounding up to the bottleneck, and come back on the way out", "[engine]") {
  const auto [side, levels] = GENERATE(table<int, std::vector<int>>(
      {{150, {150, 75, 38, 19}}, {13, {13, 7, 4, 2}}, {1, {1, 1, 1, 1}}, {8, {8, 4, 2, 1}}}));
  const std::vector<LayerSize> sizes = EncoderDecoderSizes(side, 2 * side);
  REQUIRE(sizes.size() == kEncoderDecoderLayers);
  const std::size_t level_of[] = {0, 1, 1, 2, 2, 3, 3, 2, 2, 1, 1, 0, 0};
  for (std::size_t layer = 0; layer < sizes.size(); ++layer) {
    CAPTURE(side, layer);
    CHECK(sizes[layer].rows == levels[level_of[layer]]);
  }
  CHECK(sizes[6].columns == (2 * side + 7) / 8);
}

TEST_CASE("The paper's network has 64 channels at the bottleneck and 181 thousand parameters",
          "[engine]") {
  const NetworkShape shape{16, Architecture::kEncoderDecoder};
  CHECK(shape.OutputsOf(6) == 64);
  std::size_t parameters = 0;
  for (int layer = 0; layer < shape.layers(); ++layer) {
    parameters += shape.WeightsOf(layer) + static_cast<std::size_t>(shape.OutputsOf(layer));
  }
  CHECK(parameters == 181'026);
}

TEST_CASE("Upsampling takes the pixel at floor(i from / to)", "[engine]") {
  std::vector<int> sources;
  for (int i = 0; i < 7; ++i) sources.push_back(UpsamplingSource(i, 4, 7));
  CHECK(sources == std::vector{0, 0, 1, 1, 2, 2, 3});
  CHECK(UpsamplingSource(37, 19, 38) == 18);
  CHECK(UpsamplingSource(149, 75, 150) == 74);
}

/// A channel-last image in double.
struct Image {
  LayerSize size;
  int channels = 0;
  std::vector<double> values;
  double At(int row, int column, int channel) const {
    if (row < 0 || column < 0 || row >= size.rows || column >= size.columns) return 0.0;
    return values[static_cast<std::size_t>((row * size.columns + column) * channels + channel)];
  }
};

/// Layer by layer, the biases after the weights.
using Parameters = std::vector<std::vector<double>>;

Parameters InDouble(const NetworkWeights& weights) {
  Parameters parameters;
  for (std::size_t i = 0; i < weights.weights.size(); ++i) {
    parameters.emplace_back(weights.weights[i].begin(), weights.weights[i].end());
    parameters.emplace_back(weights.biases[i].begin(), weights.biases[i].end());
  }
  return parameters;
}

Image UpsampledTo(const Image& image, LayerSize size) {
  Image result{size, image.channels, {}};
  for (int row = 0; row < size.rows; ++row) {
    for (int column = 0; column < size.columns; ++column) {
      for (int channel = 0; channel < image.channels; ++channel) {
        result.values.push_back(image.At(row * image.size.rows / size.rows,
                                         column * image.size.columns / size.columns, channel));
      }
    }
  }
  return result;
}

Image Convolved(const Image& image, LayerSize size, const std::vector<double>& weights,
                const std::vector<double>& biases) {
  const int stride = size.rows < image.size.rows || size.columns < image.size.columns ? 2 : 1;
  const int outputs = static_cast<int>(biases.size());
  Image result{size, outputs, {}};
  for (int cell = 0; cell < size.rows * size.columns; ++cell) {
    for (int o = 0; o < outputs; ++o) {
      double sum = biases[static_cast<std::size_t>(o)];
      for (int tap = 0; tap < 9; ++tap) {
        const int row = cell / size.columns * stride + tap / 3 - 1;
        const int column = cell % size.columns * stride + tap % 3 - 1;
        for (int i = 0; i < image.channels; ++i) {
          sum += image.At(row, column, i) *
                 weights[static_cast<std::size_t>((tap * image.channels + i) * outputs + o)];
        }
      }
      result.values.push_back(sum);
    }
  }
  return result;
}

/// The network as its header says it.
std::vector<double> ReferenceLogits(const Parameters& parameters, LayerSize size,
                                    const std::vector<float>& input) {
  const std::vector<LayerSize> sizes = EncoderDecoderSizes(size.rows, size.columns);
  Image image{size, kInputChannels, {input.begin(), input.end()}};
  for (std::size_t layer = 0; layer < sizes.size(); ++layer) {
    if (layer > 0) {
      for (double& value : image.values) value = std::fmax(value, 0.0);
    }
    if (layer == 7 || layer == 9 || layer == 11) image = UpsampledTo(image, sizes[layer]);
    image = Convolved(image, sizes[layer], parameters[2 * layer], parameters[2 * layer + 1]);
  }
  return image.values;
}

TEST_CASE("Logits are the reference network's at any size", "[engine]") {
  const auto [rows, columns] =
      GENERATE(table<int, int>({{1, 1}, {2, 5}, {9, 11}, {16, 16}, {21, 30}}));
  const auto weights = TinyWeights(3);
  const std::vector<float> input = InputOfSize(rows, columns, 4);
  EncoderDecoderPass pass(kTiny, rows, columns, EncoderDecoderPass::Use::kInference);
  pass.SetWeights(weights);
  const auto logits = pass.Forward(input);
  const auto expected = ReferenceLogits(InDouble(*weights), {rows, columns}, input);
  REQUIRE(logits.size() == expected.size());
  for (std::size_t i = 0; i < logits.size(); ++i) {
    CAPTURE(rows, columns, i);
    CHECK(static_cast<double>(logits[i]) == Approx(expected[i]).epsilon(1e-4).margin(1e-5));
  }
}

TEST_CASE("Gradients are the differences of the loss in every layer", "[engine]") {
  const auto [rows, columns] = GENERATE(table<int, int>({{9, 7}, {5, 12}}));
  const auto weights = TinyWeights(7);
  const std::vector<float> input = InputOfSize(rows, columns, 8);
  const std::vector<float> slopes =
      RandomValues(static_cast<std::size_t>(rows * columns * kOutputChannels), 9);
  NetworkWeights gradient = ZeroWeights(kTiny);
  EncoderDecoderPass pass(kTiny, rows, columns, EncoderDecoderPass::Use::kTraining);
  pass.SetWeights(weights);
  pass.Forward(input);
  pass.Backward(slopes, gradient);
  Parameters parameters = InDouble(*weights);
  const auto loss_with = [&](double& parameter, double change) {
    const double before = std::exchange(parameter, parameter + change);
    const auto logits = ReferenceLogits(parameters, {rows, columns}, input);
    parameter = before;
    double sum = 0.0;
    for (std::size_t i = 0; i < logits.size(); ++i)
      sum += logits[i] * static_cast<double>(slopes[i]);
    return sum;
  };
  for (std::size_t part = 0; part < parameters.size(); ++part) {
    const auto& values = (part % 2 == 0 ? gradient.weights : gradient.biases)[part / 2];
    for (std::size_t i = 0; i < values.size(); i += 1 + values.size() / 12) {
      CAPTURE(rows, columns, part, i);
      constexpr double kStep = 1e-6;
      double& parameter = parameters[part][i];
      const double slope = (loss_with(parameter, kStep) - loss_with(parameter, -kStep)) / 2 / kStep;
      CHECK(static_cast<double>(values[i]) == Approx(slope).epsilon(1e-3).margin(1e-4));
    }
  }
}

TEST_CASE("Training and inference give the same bits, before and after new weights", "[engine]") {
  const std::vector<float> input = InputOfSize(30, 41, 12);
  TrainingWeights training_weights(*TinyWeights(20));
  TrainingPass training(kTiny, 30, 41);
  EncoderDecoderPass inference(kTiny, 30, 41, EncoderDecoderPass::Use::kInference);
  for (const std::uint64_t seed : {21, 22}) {
    const auto weights = TinyWeights(seed);
    training_weights.Assign(*weights);
    inference.SetWeights(weights);
    CHECK(std::ranges::equal(training.Forward(training_weights, input), inference.Forward(input)));
  }
}

TEST_CASE("Backward adds to the gradient and gives the same bits each time", "[engine]") {
  const auto weights = TinyWeights(31);
  const std::vector<float> input = InputOfSize(12, 12, 32);
  const std::vector<float> slopes = RandomValues(12 * 12 * kOutputChannels, 33);
  EncoderDecoderPass pass(kTiny, 12, 12, EncoderDecoderPass::Use::kTraining);
  pass.SetWeights(weights);
  NetworkWeights once = ZeroWeights(kTiny);
  NetworkWeights twice = ZeroWeights(kTiny);
  for (NetworkWeights* gradient : {&once, &twice, &twice}) {
    pass.Forward(input);
    pass.Backward(slopes, *gradient);
  }
  for (float& value : once.weights[5]) value *= 2.0F;
  CHECK(once.weights[5] == twice.weights[5]);
}

}  // namespace
}  // namespace conav::nhpm
