#include "nhpm/training/batch_pass.h"

#include <algorithm>
#include <numeric>

#include "common/runtime/demand.h"
#include "common/runtime/workers.h"
#include "nhpm/training/loss.h"

namespace conav::nhpm {
namespace {

/// Calls visit(a's array, b's array) for each array of parameters.
template <class A, class B, class Visit>
void ForEachArray(A& a, B& b, Visit visit) {
  for (std::size_t i = 0; i < kNetworkLayers; ++i) {
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

struct BatchPass::Worker {
  Worker(NetworkShape shape, int rows, int columns) : pass(shape, rows, columns) {}
  TrainingPass pass;
  Example turned;
  std::vector<float> logit_gradient;
};

BatchPass::BatchPass(NetworkShape shape, int rows, int columns, int threads)
    : symmetries_(rows, columns), chunk_gradients_(kChunks, ZeroWeights(shape)) {
  DEMAND(threads > 0, threads);
  for (int i = 0; i < threads; ++i) {
    workers_.push_back(std::make_unique<Worker>(shape, rows, columns));
  }
}

BatchPass::~BatchPass() = default;

void BatchPass::AddExample(const TrainingWeights& weights, const BatchItem& item, float factor,
                           Worker& worker, NetworkWeights& gradient, double& loss) {
  symmetries_.Apply(item.symmetry, *item.example, worker.turned);
  const Example& example = worker.turned;
  const std::span<const float> logits = worker.pass.Forward(weights, example.input);
  loss = ExampleLoss(logits, example.labels);
  worker.logit_gradient.resize(logits.size());
  LossGradient(logits, example.labels, factor, worker.logit_gradient);
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
                 TrainingPass& pass = workers_[static_cast<std::size_t>(worker)]->pass;
                 losses[i] =
                     ExampleLoss(pass.Forward(weights, examples[i].input), examples[i].labels);
               });
  return losses;
}

double BatchPass::MeanLoss(const TrainingWeights& weights, std::span<const Example> examples) {
  DEMAND(!examples.empty());
  const std::vector<double> losses = Losses(weights, examples);
  return std::accumulate(losses.begin(), losses.end(), 0.0) / static_cast<double>(losses.size());
}

}  // namespace conav::nhpm
