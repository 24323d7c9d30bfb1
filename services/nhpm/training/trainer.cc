#include "nhpm/training/trainer.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "common/runtime/random.h"
#include "common/runtime/result.h"

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

/// The factors that all parameters of a step share.
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

constexpr std::uint64_t kInitialWeights = 0;  // purpose of a seed; epochs are 1, 2, ...

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
  for (auto i = static_cast<std::size_t>(first_layer); i < weights.weights.size(); ++i) {
    Step(factors, gradient.weights[i], state.first.weights[i], state.second.weights[i],
         weights.weights[i]);
    Step(factors, gradient.biases[i], state.first.biases[i], state.second.biases[i],
         weights.biases[i]);
  }
}

TrainingOptions EncoderDecoderOptions() {
  return {.architecture = Architecture::kEncoderDecoder,
          .width = 16,
          .epochs = 5000,
          .class_weight = 13.0 * 13.0 * 2.0};
}

std::unique_ptr<BatchPass> MakeBatchPass(const TrainingOptions& options, int rows, int columns,
                                         int threads) {
  std::unique_ptr<const Augmentation> augmentation;
  if (options.architecture == Architecture::kConvolutional) {
    augmentation = std::make_unique<GridSymmetries>(rows, columns);
  } else {
    augmentation = std::make_unique<CanvasAugmentation>(options.canvas, rows, columns);
  }
  return std::make_unique<BatchPass>(options.shape(), std::move(augmentation), threads,
                                     options.class_weight);
}

TrainingState InitialTrainingState(const TrainingOptions& options, double edit_share) {
  const NetworkShape shape = options.shape();
  const double odds = options.class_weight * edit_share / (1.0 - edit_share);
  const auto bias = static_cast<float>(std::log(odds));
  NetworkWeights weights = InitialWeights(shape, DeriveSeed(options.seed, kInitialWeights), bias);
  return {weights, InitialAdamState(shape), weights, 0, {}};
}

double BestValidationLoss(const TrainingState& state) {
  DEMAND(state.best_epoch > 0 && static_cast<std::size_t>(state.best_epoch) <= state.epochs.size(),
         state.best_epoch, state.epochs.size());
  return state.epochs[static_cast<std::size_t>(state.best_epoch) - 1].validation_loss;
}

Trainer::Trainer(const TrainingOptions& options, const ExampleSet& train,
                 const ExampleSet& validation, int threads, TrainingState state)
    : options_(options),
      train_(train),
      validation_(validation),
      state_(std::move(state)),
      pass_(MakeBatchPass(options, train.rows, train.columns, threads)),
      packed_(state_.weights),
      gradient_(ZeroWeights(options.shape())) {
  DEMAND(!train.examples.empty() && !validation.examples.empty(), train.examples.size(),
         validation.examples.size());
  DEMAND(train.rows == validation.rows && train.columns == validation.columns, train.rows,
         train.columns, validation.rows, validation.columns);
}

bool Trainer::finished() const {
  const int done = static_cast<int>(state_.epochs.size());
  const bool tired = options_.patience > 0 && done - state_.best_epoch >= options_.patience;
  return done >= options_.epochs || tired;
}

std::vector<BatchItem> Trainer::DrawEpoch() const {
  Random random(DeriveSeed(options_.seed, state_.epochs.size() + 1));
  std::vector<BatchItem> items;
  for (const Example& example : train_.examples) items.push_back({&example, 0});
  random.Shuffle(items);
  for (BatchItem& item : items) item.variant = pass_->augmentation().Draw(random);
  return items;
}

AdamOptions Trainer::OptionsOfEpoch() const {
  double rate = options_.learning_rate;
  if (options_.schedule == LearningRateSchedule::kLinear) {
    rate *= 1.0 - static_cast<double>(state_.epochs.size()) / options_.epochs;
  }
  return {.learning_rate = static_cast<float>(rate)};
}

std::optional<EpochReport> Trainer::RunEpoch(const std::function<bool()>& stop_requested) {
  DEMAND(!finished());
  const TrainingState before = state_;
  const AdamOptions adam = OptionsOfEpoch();
  const std::vector<BatchItem> items = DrawEpoch();
  const std::size_t batch = static_cast<std::size_t>(options_.batch);
  double loss = 0.0;
  for (std::size_t i = 0; i < items.size(); i += batch) {
    if (stop_requested()) {
      state_ = before;
      packed_.Assign(state_.weights);
      return std::nullopt;
    }
    const auto part = std::span(items).subspan(i, std::min(batch, items.size() - i));
    loss += pass_->Gradient(packed_, part, gradient_);
    AdamStep(adam, gradient_, state_.adam, state_.weights);
    packed_.Assign(state_.weights);
  }
  state_.epochs.push_back({static_cast<int>(state_.epochs.size()) + 1,
                           loss / static_cast<double>(items.size()),
                           pass_->MeanLoss(packed_, validation_.examples)});
  KeepBest();
  return state_.epochs.back();
}

void Trainer::KeepBest() {
  const EpochReport& last = state_.epochs.back();
  if (state_.best_epoch > 0 && !(last.validation_loss < BestValidationLoss(state_))) return;
  state_.best = state_.weights;
  state_.best_epoch = last.epoch;
}

}  // namespace conav::nhpm
