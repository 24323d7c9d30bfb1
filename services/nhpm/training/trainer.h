#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "common/runtime/threads.h"
#include "nhpm/engine/network_weights.h"
#include "nhpm/training/batch_pass.h"

namespace conav::nhpm {

/// The defaults of D. P. Kingma and J. Ba, "Adam: A Method for Stochastic Optimization", ICLR 2015.
struct AdamOptions {
  float learning_rate = 1e-3F;
  float beta1 = 0.9F;
  float beta2 = 0.999F;
  float epsilon = 1e-8F;
};

struct AdamState {
  NetworkWeights first;   // moving mean of the gradient
  NetworkWeights second;  // ... of its square
  std::uint64_t steps = 0;
  bool operator==(const AdamState&) const = default;
};

AdamState InitialAdamState(NetworkShape shape);

/// One step down `gradient`; layers below `first_layer` stay as they are.
void AdamStep(const AdamOptions& options, const NetworkWeights& gradient, AdamState& state,
              NetworkWeights& weights, int first_layer = 0);

/// How the learning rate changes from the first epoch to the last.
enum class LearningRateSchedule : std::uint8_t {
  kConstant,  // the paper's
  kLinear,    // down to 0 after the last epoch
};

/// Defaults: paper Appendix B, except for the patience, which it leaves open.
struct TrainingOptions {
  Architecture architecture = Architecture::kConvolutional;
  int width = 32;
  int epochs = 200;  // at most
  int batch = 128;
  double learning_rate = 1e-3;
  LearningRateSchedule schedule = LearningRateSchedule::kConstant;
  int patience = 30;  // stop after this many epochs without a better validation loss; 0 = never
  std::uint64_t seed = 1;
  double class_weight = 1.0;  // of edited outputs in the loss
  int canvas = kPaperCanvas;  // of an encoder-decoder: rows and columns of its examples, in pixels

  NetworkShape shape() const { return {width, architecture}; }
  bool operator==(const TrainingOptions&) const = default;
};

/// The encoder-decoder's, with the paper's bottleneck of 64 channels, 5000 epochs and class weight
/// 13 * 13 * 2.
TrainingOptions EncoderDecoderOptions();

/// What runs the network of `options` on examples of that shape.
std::unique_ptr<BatchPass> MakeBatchPass(const TrainingOptions& options, int rows, int columns,
                                         int threads);

struct EpochReport {
  int epoch = 0;                 // from 1
  double train_loss = 0.0;       // MBCE, mean over the epoch while the weights moved
  double validation_loss = 0.0;  // MBCE after the epoch
  bool operator==(const EpochReport&) const = default;
};

/// The complete state for resuming a training. The random numbers of an epoch follow from seed and
/// epoch.
struct TrainingState {
  NetworkWeights weights;
  AdamState adam;
  NetworkWeights best;  // of the lowest validation loss
  int best_epoch = 0;   // 0 = none yet
  std::vector<EpochReport> epochs;
  bool operator==(const TrainingState&) const = default;
};

/// Before the first epoch. The last biases start at the logit of `edit_share` (EditShare).
TrainingState InitialTrainingState(const TrainingOptions& options, double edit_share);

/// Trains a network of paper Appendix B: Adam, mini-batches, a random symmetry (for an
/// encoder-decoder a random placement) of each example in each epoch, early stopping on the
/// validation loss.
///
/// The result depends on options and examples only: the same bits on any number of threads, and
/// after any number of interruptions that keep the state; of an encoder-decoder on processors with
/// one instruction set.
class Trainer {
 public:
  /// Keeps references to the sets; both have examples, of one shape. `threads` > 0.
  Trainer(const TrainingOptions& options, const ExampleSet& train, const ExampleSet& validation,
          int threads, TrainingState state);

  /// One pass over the training examples, then one over the validation examples. Empty, with the
  /// state unchanged, when `stop` interrupts it. Requires !finished().
  std::optional<EpochReport> RunEpoch(const StopToken& stop) {
    return RunEpoch([&] { return stop.stop_requested(); });
  }
  /// The same; calls `stop_requested` before each batch.
  std::optional<EpochReport> RunEpoch(const std::function<bool()>& stop_requested);

  /// All epochs done, or `patience` of them without a better validation loss.
  bool finished() const;
  const TrainingState& state() const { return state_; }

 private:
  std::vector<BatchItem> DrawEpoch() const;
  AdamOptions OptionsOfEpoch() const;
  void KeepBest();

  TrainingOptions options_;
  const ExampleSet& train_;
  const ExampleSet& validation_;
  TrainingState state_;
  std::unique_ptr<BatchPass> pass_;
  TrainingWeights packed_;
  NetworkWeights gradient_;
};

/// The validation loss of `best_epoch`. Requires best_epoch > 0.
double BestValidationLoss(const TrainingState& state);

}  // namespace conav::nhpm
