#include "nhpm/training/batch_pass.h"

#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <set>
#include <utility>

#include "unit/nhpm/training/made_up_examples.h"

namespace conav::nhpm {
namespace {

std::vector<BatchItem> Batch(const ExampleSet& set) {
  std::vector<BatchItem> items;
  for (const Example& example : set.examples) {
    items.push_back({&example, items.size() % 4});
  }
  return items;
}

TEST_CASE("Loss and gradient have the same bits on any number of threads", "[training]") {
  const int count = GENERATE(1, 15, 37);
  const ExampleSet set = MadeUpExamples(7, 6, count, 3);
  const NetworkWeights weights = InitialWeights({16}, 4);
  const TrainingWeights packed(weights);
  NetworkWeights expected = ZeroWeights({16});
  const double loss = BatchPass({16}, 7, 6, 1).Gradient(packed, Batch(set), expected);
  const double mean = BatchPass({16}, 7, 6, 1).MeanLoss(packed, set.examples);
  for (const int threads : {2, 3, 20}) {
    BatchPass pass({16}, 7, 6, threads);
    NetworkWeights gradient = ZeroWeights({16});
    CHECK(pass.Gradient(packed, Batch(set), gradient) == loss);
    CHECK((gradient == expected));
    CHECK(pass.MeanLoss(packed, set.examples) == mean);
  }
}

/// A layer in double, as the paper's appendix says it.
std::vector<double> Convolve(const ExampleSet& set, const std::vector<double>& in,
                             const std::vector<double>& weights,
                             const std::vector<double>& biases) {
  const int outputs = static_cast<int>(biases.size());
  const int inputs = static_cast<int>(weights.size()) / outputs / 9;
  std::vector<double> out;
  for (int cell = 0; cell < set.rows * set.columns; ++cell) {
    for (int o = 0; o < outputs; ++o) {
      double sum = biases[static_cast<std::size_t>(o)];
      for (int tap = 0; tap < 9; ++tap) {
        const int row = cell / set.columns + tap / 3 - 1;
        const int column = cell % set.columns + tap % 3 - 1;
        if (row < 0 || column < 0 || row >= set.rows || column >= set.columns) continue;
        for (int i = 0; i < inputs; ++i) {
          sum += in[static_cast<std::size_t>((row * set.columns + column) * inputs + i)] *
                 weights[static_cast<std::size_t>((tap * inputs + i) * outputs + o)];
        }
      }
      out.push_back(sum);
    }
  }
  return out;
}

/// A network's weights in double: layer by layer, the biases after the weights.
using Parameters = std::vector<std::vector<double>>;

/// Of the first example, to differentiate by differences.
double ReferenceLoss(const Parameters& parameters, const ExampleSet& set) {
  const Example& example = set.examples[0];
  std::vector<double> values(example.input.begin(), example.input.end());
  for (std::size_t i = 0; i < parameters.size(); i += 2) {
    if (i > 0)
      std::ranges::transform(values, values.begin(), [](double x) { return std::fmax(x, 0.0); });
    values = Convolve(set, values, parameters[i], parameters[i + 1]);
  }
  double sum = 0.0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (example.labels[i] == OutputLabel::kMasked) continue;
    const bool edited = example.labels[i] == OutputLabel::kEdited;
    sum += std::log1p(std::exp(edited ? -values[i] : values[i]));
  }
  return sum / static_cast<double>(values.size());
}

TEST_CASE("The loss is the reference network's, the gradient its differences in every layer",
          "[training]") {
  const ExampleSet set = MadeUpExamples(5, 6, 1, 11);
  const NetworkShape shape{GENERATE(16, 32, 64)};
  NetworkWeights weights = InitialWeights(shape, 12, -1.0F);
  Random random(13);
  Parameters parameters;
  for (std::size_t layer = 0; layer < kNetworkLayers; ++layer) {
    std::vector<float>& biases = weights.biases[layer];
    for (float& bias : biases) bias += static_cast<float>(0.2 * random.Unit() - 0.1);
    parameters.emplace_back(weights.weights[layer].begin(), weights.weights[layer].end());
    parameters.emplace_back(biases.begin(), biases.end());
  }
  NetworkWeights gradient = ZeroWeights(shape);
  const BatchItem item{&set.examples[0], 0};
  BatchPass(shape, 5, 6, 1).Gradient(TrainingWeights(weights), {&item, 1}, gradient);
  CHECK(BatchPass(shape, 5, 6, 1).MeanLoss(TrainingWeights(weights), set.examples) ==
        Approx(ReferenceLoss(parameters, set)).epsilon(1e-5));
  const auto loss_with = [&](double& parameter, double change) {
    const double before = std::exchange(parameter, parameter + change);
    const double loss = ReferenceLoss(parameters, set);
    parameter = before;
    return loss;
  };
  for (std::size_t part = 0; part < parameters.size(); ++part) {
    const auto& values = (part % 2 == 0 ? gradient.weights : gradient.biases)[part / 2];
    for (std::size_t i = 0; i < values.size(); i += 1 + values.size() / 20) {
      CAPTURE(shape.width, part, i);
      constexpr double kStep = 1e-6;
      double& parameter = parameters[part][i];
      const double slope = (loss_with(parameter, kStep) - loss_with(parameter, -kStep)) / 2 / kStep;
      CHECK(static_cast<double>(values[i]) == Approx(slope).epsilon(2e-4).margin(2e-7));
    }
  }
}

TEST_CASE("The gradient of a batch is the mean of its examples' gradients", "[training]") {
  const ExampleSet set = MadeUpExamples(5, 5, 2, 17);
  const TrainingWeights packed(InitialWeights({16}, 18));
  BatchPass pass({16}, 5, 5, 1);
  std::vector<NetworkWeights> single(2, ZeroWeights({16}));
  for (std::size_t i = 0; i < 2; ++i) {
    const BatchItem item{&set.examples[i], 0};
    pass.Gradient(packed, {&item, 1}, single[i]);
  }
  NetworkWeights both = ZeroWeights({16});
  const std::vector<BatchItem> items{{&set.examples[0], 0}, {&set.examples[1], 0}};
  pass.Gradient(packed, items, both);
  NetworkWeights fresh = ZeroWeights({16});
  BatchPass({16}, 5, 5, 1).Gradient(packed, items, fresh);
  CHECK((both == fresh));  // it does not remember the batches before
  for (std::size_t i = 0; i < both.weights[2].size(); ++i) {
    const float mean = 0.5F * (single[0].weights[2][i] + single[1].weights[2][i]);
    CHECK(both.weights[2][i] == Approx(mean).margin(1e-8));
  }
}

/// Behind a transposition, mirroring rows is mirroring columns before it.
int InverseOf(int element) {
  if ((element & 4) == 0) return element;
  return 4 | ((element & 1) << 1) | ((element & 2) >> 1);
}

TEST_CASE("A square has eight different symmetries, another rectangle four, each with its inverse",
          "[training]") {
  const auto [rows, columns, count] =
      GENERATE(table<int, int, std::size_t>({{5, 5, 8}, {4, 7, 4}, {1, 3, 0}, {1, 1, 0}}));
  const Example example = MadeUpExamples(rows, columns, 1, 5).examples[0];
  const GridSymmetries symmetries(rows, columns);
  std::set<std::vector<float>> all;
  for (int element = 0; element < symmetries.count(); ++element) {
    INFO(rows << " x " << columns << " element " << element);
    Example turned;
    Example back;
    symmetries.Apply(element, example, turned);
    symmetries.Apply(InverseOf(element), turned, back);
    CHECK((back == example));
    all.insert(turned.input);
  }
  if (count > 0) CHECK(all.size() == count);  // a line of cells has fewer
}

TEST_CASE("A symmetry moves the channels and labels of a cell together", "[training]") {
  const auto [element, to] =
      GENERATE(table<int, std::size_t>({{0, 0}, {1, 2}, {2, 1}, {3, 3}, {4, 0}, {6, 2}}));
  CAPTURE(element);  // 1: rows mirrored, 2: columns, 4: transposed first
  Example example{std::vector<float>(16, 0.0F), std::vector<OutputLabel>(8, OutputLabel::kKept)};
  example.input[3] = 1.0F;  // the last channel of the first of 2 x 2 cells
  example.labels[1] = OutputLabel::kEdited;
  Example turned;
  GridSymmetries(2, 2).Apply(element, example, turned);
  CHECK(turned.input[to * kInputChannels + 3] == 1.0F);
  CHECK(turned.labels[to * kOutputChannels + 1] == OutputLabel::kEdited);
}

using enum OutputLabel;

TEST_CASE("Softplus agrees with the standard library's, without overflow at the ends",
          "[training]") {
  for (double x = -60.0; x <= 60.0; x += 0.37) {
    INFO(x);
    const double expected = std::fmax(x, 0.0) + std::log1p(std::exp(-std::fabs(x)));
    CHECK(Softplus(x) == Approx(expected).epsilon(2e-15));
  }
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  CHECK(Softplus(0.0) == Approx(std::log(2.0)).epsilon(1e-15));
  CHECK(Softplus(1e300) == 1e300);
  CHECK(Softplus(-1e300) == 0.0);
  CHECK(Softplus(kInfinity) == kInfinity);
  CHECK(Softplus(-kInfinity) == 0.0);
  CHECK(std::isnan(Softplus(std::nan(""))));
}

TEST_CASE("The loss is the mean over all outputs, its gradient p - y, masked ones cost nothing",
          "[training]") {
  std::array<float, 4> logits{0.0F, 2.0F, 7.0F, -3.0F};
  const std::array<OutputLabel, 4> labels{kKept, kEdited, kMasked, kMasked};
  // (-log(1/2) - log(1 / (1 + e^-2))) / 4
  CHECK(ExampleLoss(logits, labels) == Approx((0.6931471806 + 0.1269280110) / 4.0));
  logits[1] = 0.0F;
  std::array<float, 4> gradient{};
  LossGradient(logits, labels, 2.0F, gradient);
  CHECK(gradient == std::array<float, 4>{0.25F, -0.25F, 0.0F, 0.0F});
  LossGradient(logits, labels, 2.0F, gradient, 3.0);  // edits count three times
  CHECK(gradient == std::array<float, 4>{0.25F, -0.75F, 0.0F, 0.0F});
  CHECK(ExampleLoss(logits, labels, 3.0) == Approx(4.0 * 0.6931471806 / 4.0));
}

}  // namespace
}  // namespace conav::nhpm
