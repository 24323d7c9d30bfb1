#include "nhpm/training/batch_pass.h"

#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <set>

#include "unit/nhpm/training/made_up_examples.h"

namespace conav::nhpm {
namespace {

std::vector<BatchItem> Batch(const ExampleSet& set) {
  std::vector<BatchItem> items;
  for (const Example& example : set.examples) {
    items.push_back({&example, static_cast<int>(items.size() % 4)});
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

/// One of a network's numbers.
struct Parameter {
  std::size_t layer = 0;
  bool is_bias = false;
  std::size_t index = 0;
};

/// A network in double, written as the paper's appendix says it, to differentiate by differences.
class ReferenceNetwork {
 public:
  ReferenceNetwork(int rows, int columns) : rows_(rows), columns_(columns) {}

  /// After adding `change` to one parameter.
  double Loss(const NetworkWeights& weights, const Example& example,
              const Parameter& parameter = {}, double change = 0.0) const {
    std::vector<double> values(example.input.begin(), example.input.end());
    for (int i = 0; i < kNetworkLayers; ++i) {
      const auto at = static_cast<std::size_t>(i);
      std::vector<double> w(weights.weights[at].begin(), weights.weights[at].end());
      std::vector<double> biases(weights.biases[at].begin(), weights.biases[at].end());
      if (at == parameter.layer) (parameter.is_bias ? biases : w)[parameter.index] += change;
      values = Convolve(values, w, biases, weights.shape.InputsOf(i));
      if (i + 1 < kNetworkLayers) {
        for (double& value : values) value = std::fmax(value, 0.0);
      }
    }
    return LossOf(values, example.labels);
  }

 private:
  std::vector<double> Convolve(const std::vector<double>& in, const std::vector<double>& w,
                               const std::vector<double>& biases, int inputs) const {
    const int outputs = static_cast<int>(biases.size());
    std::vector<double> out;
    for (int cell = 0; cell < rows_ * columns_; ++cell) {
      for (int o = 0; o < outputs; ++o) {
        double sum = biases[static_cast<std::size_t>(o)];
        for (int tap = 0; tap < 9; ++tap) {
          const int row = cell / columns_ + tap / 3 - 1;
          const int column = cell % columns_ + tap % 3 - 1;
          if (row < 0 || column < 0 || row >= rows_ || column >= columns_) continue;
          for (int i = 0; i < inputs; ++i) {
            sum += in[static_cast<std::size_t>((row * columns_ + column) * inputs + i)] *
                   w[static_cast<std::size_t>((tap * inputs + i) * outputs + o)];
          }
        }
        out.push_back(sum);
      }
    }
    return out;
  }

  static double LossOf(const std::vector<double>& logits, const std::vector<OutputLabel>& labels) {
    double sum = 0.0;
    for (std::size_t i = 0; i < labels.size(); ++i) {
      if (labels[i] == OutputLabel::kMasked) continue;
      sum += std::log1p(std::exp(labels[i] == OutputLabel::kEdited ? -logits[i] : logits[i]));
    }
    return sum / static_cast<double>(labels.size());
  }

  int rows_;
  int columns_;
};

TEST_CASE("The loss is the reference network's, the gradient its differences in every layer",
          "[training]") {
  const ExampleSet set = MadeUpExamples(5, 6, 1, 11);
  const Example& example = set.examples[0];
  const NetworkShape shape{GENERATE(16, 32, 64)};
  NetworkWeights weights = InitialWeights(shape, 12, -1.0F);
  Random random(13);
  for (auto& biases : weights.biases) {
    for (float& bias : biases) bias += static_cast<float>(0.2 * random.Unit() - 0.1);
  }
  NetworkWeights gradient = ZeroWeights(shape);
  const BatchItem item{&example, 0};
  BatchPass(shape, 5, 6, 1).Gradient(TrainingWeights(weights), {&item, 1}, gradient);
  const ReferenceNetwork reference(5, 6);
  CHECK(BatchPass(shape, 5, 6, 1).MeanLoss(TrainingWeights(weights), set.examples) ==
        Approx(reference.Loss(weights, example)).epsilon(1e-5));
  for (std::size_t layer = 0; layer < kNetworkLayers; ++layer) {
    for (const bool is_bias : {false, true}) {
      const std::vector<float>& values = (is_bias ? gradient.biases : gradient.weights)[layer];
      for (std::size_t i = 0; i < values.size(); i += 1 + values.size() / 20) {
        INFO("width " << shape.width << " layer " << layer << (is_bias ? " bias " : " weight ")
                      << i);
        constexpr double kStep = 1e-6;
        const Parameter parameter{layer, is_bias, i};
        const double slope = (reference.Loss(weights, example, parameter, kStep) -
                              reference.Loss(weights, example, parameter, -kStep)) /
                             (2.0 * kStep);
        CHECK(static_cast<double>(values[i]) == Approx(slope).epsilon(2e-4).margin(2e-7));
      }
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
}

}  // namespace
}  // namespace conav::nhpm
