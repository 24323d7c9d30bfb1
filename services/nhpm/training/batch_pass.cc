#include "nhpm/training/batch_pass.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "common/runtime/result.h"
#include "common/runtime/threads.h"

namespace conav::nhpm {
namespace {

/// exp(-a) for a >= 0: 2^-k exp(-r) with r in [-ln(2) / 2, ln(2) / 2], by its Taylor series.
double ExpMinus(double a) {
  constexpr double kLn2High = 0x1.62e42fefa3800p-1;  // its last bits are 0: k kLn2High is exact
  constexpr double kLn2Low = 0x1.ef35793c76730p-45;
  if (a > 740.0) return 0.0;
  const double k = std::floor(a / (kLn2High + kLn2Low) + 0.5);
  const double r = (a - k * kLn2High) - k * kLn2Low;
  double sum = 1.0;
  for (int n = 14; n > 0; --n) sum = 1.0 - r / n * sum;
  return std::ldexp(sum, -static_cast<int>(k));
}

/// log(1 + t) for t in [0, 1]: 2 artanh(s), s = t / (2 + t) <= 1/3, by its series.
double LogOnePlus(double t) {
  const double s = t / (2.0 + t);
  double sum = 0.0;
  for (int n = 33; n > 0; n -= 2) sum = sum * (s * s) + 1.0 / n;
  return 2.0 * s * sum;
}

/// Calls visit(a's array, b's array) for each array of parameters.
template <class A, class B, class Visit>
void ForEachArray(A& a, B& b, Visit visit) {
  for (std::size_t i = 0; i < a.weights.size(); ++i) {
    visit(a.weights[i], b.weights[i]);
    visit(a.biases[i], b.biases[i]);
  }
}

void SetZero(NetworkWeights& weights) {
  ForEachArray(weights, weights, [](auto& a, auto&) { std::fill(a.begin(), a.end(), 0.0F); });
}

void Add(const NetworkWeights& from, NetworkWeights& to) {
  ForEachArray(from, to, [](const auto& a, auto& b) {
    for (std::size_t i = 0; i < b.size(); ++i) b[i] += a[i];
  });
}

}  // namespace

double Softplus(double x) {
  if (std::isnan(x)) return x;
  return std::fmax(x, 0.0) + LogOnePlus(ExpMinus(std::fabs(x)));
}

double ExampleLoss(std::span<const float> logits, std::span<const OutputLabel> labels,
                   double class_weight) {
  DEMAND(logits.size() == labels.size(), logits.size(), labels.size());
  double sum = 0.0;
  for (std::size_t i = 0; i < labels.size(); ++i) {
    if (labels[i] == OutputLabel::kMasked) continue;
    const double logit = static_cast<double>(logits[i]);
    sum += labels[i] == OutputLabel::kEdited ? class_weight * Softplus(-logit) : Softplus(logit);
  }
  return sum / static_cast<double>(labels.size());
}

void LossGradient(std::span<const float> logits, std::span<const OutputLabel> labels, float factor,
                  std::span<float> gradient, double class_weight) {
  DEMAND(logits.size() == labels.size() && gradient.size() == labels.size(), logits.size(),
         labels.size(), gradient.size());
  const float scale = factor / static_cast<float>(labels.size());
  const float edit_scale = scale * static_cast<float>(class_weight);
  for (std::size_t i = 0; i < labels.size(); ++i) {
    const bool edited = labels[i] == OutputLabel::kEdited;
    const float difference = Sigmoid(logits[i]) - (edited ? 1.0F : 0.0F);
    gradient[i] =
        labels[i] == OutputLabel::kMasked ? 0.0F : difference * (edited ? edit_scale : scale);
  }
}

struct BatchPass::Worker {
  Worker(NetworkShape shape, int rows, int columns) : pass(shape, rows, columns) {}
  TrainingPass pass;
  Example variant;
  std::vector<float> logit_gradient;
};

BatchPass::BatchPass(NetworkShape shape, int rows, int columns, int threads)
    : BatchPass(shape, std::make_unique<GridSymmetries>(rows, columns), threads, 1.0) {}

BatchPass::BatchPass(NetworkShape shape, std::unique_ptr<const Augmentation> augmentation,
                     int threads, double class_weight)
    : augmentation_(std::move(augmentation)),
      class_weight_(class_weight),
      chunk_gradients_(kChunks, ZeroWeights(shape)) {
  DEMAND(threads > 0, threads);
  for (int i = 0; i < threads; ++i) {
    workers_.push_back(
        std::make_unique<Worker>(shape, augmentation_->rows(), augmentation_->columns()));
  }
}

BatchPass::~BatchPass() = default;

void BatchPass::AddExample(const TrainingWeights& weights, const BatchItem& item, float factor,
                           Worker& worker, NetworkWeights& gradient, double& loss) {
  augmentation_->Apply(item.variant, *item.example, worker.variant);
  const Example& example = worker.variant;
  const std::span<const float> logits = worker.pass.Forward(weights, example.input);
  loss = Loss(logits, example.labels);
  worker.logit_gradient.resize(logits.size());
  LossGradient(logits, example.labels, factor, worker.logit_gradient, class_weight_);
  worker.pass.Backward(weights, worker.logit_gradient, gradient);
}

void BatchPass::SumChunks(NetworkWeights& gradient) const {
  SetZero(gradient);
  for (const NetworkWeights& chunk : chunk_gradients_) Add(chunk, gradient);
}

double BatchPass::Gradient(const TrainingWeights& weights, std::span<const BatchItem> batch,
                           NetworkWeights& gradient) {
  DEMAND(!batch.empty());
  const std::size_t chunk_size = (batch.size() + kChunks - 1) / kChunks;
  const float factor = 1.0F / static_cast<float>(batch.size());
  std::vector<double> losses(batch.size());
  RunOnWorkers(static_cast<int>(workers_.size()), kChunks, [&](int worker, int chunk) {
    NetworkWeights& sum = chunk_gradients_[static_cast<std::size_t>(chunk)];
    SetZero(sum);
    const std::size_t begin = static_cast<std::size_t>(chunk) * chunk_size;
    for (std::size_t i = begin; i < std::min(begin + chunk_size, batch.size()); ++i) {
      AddExample(weights, batch[i], factor, *workers_[static_cast<std::size_t>(worker)], sum,
                 losses[i]);
    }
  });
  SumChunks(gradient);
  return std::accumulate(losses.begin(), losses.end(), 0.0);
}

std::vector<double> BatchPass::Losses(const TrainingWeights& weights,
                                      std::span<const Example> examples) {
  std::vector<double> losses(examples.size());
  RunOnWorkers(static_cast<int>(workers_.size()), static_cast<int>(examples.size()),
               [&](int worker, int index) {
                 const auto i = static_cast<std::size_t>(index);
                 Worker& w = *workers_[static_cast<std::size_t>(worker)];
                 augmentation_->Apply(augmentation_->FixedVariant(i), examples[i], w.variant);
                 losses[i] = Loss(w.pass.Forward(weights, w.variant.input), w.variant.labels);
               });
  return losses;
}

double BatchPass::MeanLoss(const TrainingWeights& weights, std::span<const Example> examples) {
  DEMAND(!examples.empty());
  const std::vector<double> losses = Losses(weights, examples);
  return std::accumulate(losses.begin(), losses.end(), 0.0) / static_cast<double>(losses.size());
}

}  // namespace conav::nhpm
