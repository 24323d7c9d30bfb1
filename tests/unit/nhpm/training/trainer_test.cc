#include "nhpm/training/trainer.h"

#include <catch2/catch.hpp>

#include "unit/nhpm/training/made_up_examples.h"

namespace conav::nhpm {
namespace {

TrainingOptions SmallTraining() {
  return {.width = 16, .epochs = 5, .batch = 10, .learning_rate = 3e-3};
}

TrainingState Initial(const TrainingOptions& options) { return InitialTrainingState(options, 0.1); }

const StopToken kNoStop;

void RunToEnd(Trainer& trainer) {
  while (!trainer.finished()) REQUIRE(trainer.RunEpoch(kNoStop));
}

TrainingState Trained(const TrainingOptions& options, const ExampleSet& train,
                      const ExampleSet& validation, int threads = 1) {
  Trainer trainer(options, train, validation, threads, Initial(options));
  RunToEnd(trainer);
  return trainer.state();
}

TEST_CASE("A training gives the same bits on one, two and three threads, others with another seed",
          "[training]") {
  const ExampleSet train = MadeUpExamples(5, 5, 23, 1);
  const ExampleSet validation = MadeUpExamples(5, 5, 7, 2);
  TrainingOptions options = SmallTraining();
  const TrainingState one = Trained(options, train, validation);
  CHECK(one.epochs.size() == 5);
  for (const int threads : {2, 3}) {
    CHECK((Trained(options, train, validation, threads) == one));
  }
  options.seed = 2;
  CHECK_FALSE((Trained(options, train, validation).weights == one.weights));
}

TEST_CASE("A training that is taken up again ends as one that was not interrupted", "[training]") {
  const ExampleSet train = MadeUpExamples(5, 6, 23, 1);
  const ExampleSet validation = MadeUpExamples(5, 6, 7, 2);
  TrainingOptions options = SmallTraining();
  options.schedule = GENERATE(LearningRateSchedule::kConstant, LearningRateSchedule::kLinear);
  TrainingState state = Initial(options);
  for (int epoch = 0; epoch < 5; ++epoch) {
    Trainer part(options, train, validation, 1 + epoch % 2, state);
    REQUIRE(part.RunEpoch(kNoStop));
    state = part.state();
  }
  CHECK((state == Trained(options, train, validation)));
}

TEST_CASE("A stop leaves the state of the last whole epoch, and the training can go on",
          "[training]") {
  const ExampleSet set = MadeUpExamples(5, 5, 23, 1);
  const TrainingOptions options = SmallTraining();
  Trainer trainer(options, set, set, 1, Initial(options));
  REQUIRE(trainer.RunEpoch(kNoStop));
  const TrainingState before = trainer.state();
  int asked = 0;
  CHECK_FALSE(trainer.RunEpoch([&] { return ++asked > 1; }));  // after the first batch
  CHECK(asked == 2);
  CHECK((trainer.state() == before));
  RunToEnd(trainer);
  CHECK((trainer.state() == Trained(options, set, set)));
}

TEST_CASE(
    "It stops after as many epochs without a better loss as it has patience, and keeps the best",
    "[training]") {
  // The validation examples follow the opposite rule: what is learned makes them worse.
  const ExampleSet train = MadeUpExamples(5, 5, 20, 1);
  ExampleSet validation = MadeUpExamples(5, 5, 5, 2);
  for (Example& example : validation.examples) {
    for (OutputLabel& label : example.labels) {
      if (label == OutputLabel::kMasked) continue;
      label = label == OutputLabel::kKept ? OutputLabel::kEdited : OutputLabel::kKept;
    }
  }
  TrainingOptions options = SmallTraining();
  options.epochs = 60;
  options.patience = 3;
  Trainer trainer(options, train, validation, 2, Initial(options));
  NetworkWeights best;
  double lowest = 1e9;
  int best_epoch = 0;
  while (!trainer.finished()) {
    const EpochReport report = trainer.RunEpoch(kNoStop).value();
    if (report.validation_loss >= lowest) continue;
    lowest = report.validation_loss;
    best_epoch = report.epoch;
    best = trainer.state().weights;
  }
  const TrainingState& state = trainer.state();
  CHECK(state.best_epoch == best_epoch);
  CHECK(static_cast<int>(state.epochs.size()) == best_epoch + 3);
  CHECK((state.best == best));
  CHECK_FALSE((state.best == state.weights));
  CHECK(BestValidationLoss(state) == lowest);
}

TEST_CASE("A linear schedule takes smaller steps from the second epoch on", "[training]") {
  const ExampleSet set = MadeUpExamples(5, 5, 11, 1);
  TrainingOptions options = SmallTraining();
  Trainer constant(options, set, set, 1, Initial(options));
  options.schedule = LearningRateSchedule::kLinear;
  Trainer linear(options, set, set, 1, Initial(options));
  REQUIRE(constant.RunEpoch(kNoStop));
  REQUIRE(linear.RunEpoch(kNoStop));
  CHECK((constant.state() == linear.state()));
  REQUIRE(constant.RunEpoch(kNoStop));
  REQUIRE(linear.RunEpoch(kNoStop));
  CHECK_FALSE((constant.state().weights == linear.state().weights));
}

constexpr NetworkShape kShape{16};

TEST_CASE("Adam's first step has the length of the learning rate, the second weighs both gradients",
          "[training]") {
  NetworkWeights weights = ZeroWeights(kShape);
  NetworkWeights gradient = ZeroWeights(kShape);
  gradient.weights[1][7] = 0.5F;
  gradient.biases[3][1] = -1e-3F;
  gradient.biases[0][0] = 1.0F;
  AdamState state = InitialAdamState(kShape);
  AdamStep({.learning_rate = 0.01F}, gradient, state, weights);
  CHECK(state.steps == 1);
  CHECK(weights.weights[1][7] == Approx(-0.01).epsilon(1e-4));
  CHECK(weights.biases[3][1] == Approx(0.01).epsilon(1e-4));
  CHECK(weights.weights[1][8] == 0.0F);
  gradient.biases[0][0] = 3.0F;
  AdamStep({.learning_rate = 0.01F}, gradient, state, weights);
  // m = (0.09 + 0.3) / 0.19, v = (0.000999 + 0.009) / 0.001999
  CHECK(weights.biases[0][0] == Approx(-0.01 - 0.01 * 2.0526316 / 2.2365131).epsilon(1e-4));
}

}  // namespace
}  // namespace conav::nhpm
