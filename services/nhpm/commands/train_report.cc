#include "nhpm/commands/train_report.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "common/console/progress_line.h"
#include "nhpm/model/input_names.h"

namespace conav::nhpm {
namespace {

double LossOf(const NetworkWeights& weights, const ExampleSet& set, int threads) {
  BatchPass pass(weights.shape, set.rows, set.columns, threads);
  return pass.MeanLoss(TrainingWeights(weights), set.examples);
}

const char* StopReason(const TrainArguments& arguments, const TrainingState& state) {
  const bool all = static_cast<int>(state.epochs.size()) >= arguments.options.epochs;
  return all ? "all epochs done" : "no better validation loss";
}

nlohmann::ordered_json ToJson(const EpochReport& epoch) {
  return {{"epoch", epoch.epoch},
          {"train_mbce", epoch.train_loss},
          {"validation_mbce", epoch.validation_loss}};
}

}  // namespace

nlohmann::ordered_json ReportJson(const TrainArguments& arguments, const TrainingOutcome& outcome,
                                  const TrainingState& state) {
  nlohmann::ordered_json document{{"weights", arguments.out.string()},
                                  {"checksum", ChecksumOf(outcome.model)},
                                  {"data_origin", outcome.model.data_origin},
                                  {"training", outcome.model.training},
                                  {"best_epoch", state.best_epoch},
                                  {"validation_mbce", BestValidationLoss(state)},
                                  {"test_mbce", outcome.test_loss},
                                  {"threads", arguments.threads},
                                  {"seconds", outcome.seconds},
                                  {"epochs", nlohmann::ordered_json::array()}};
  for (const EpochReport& epoch : state.epochs) document["epochs"].push_back(ToJson(epoch));
  return document;
}

std::map<std::string, std::string> SettingsOf(const TrainArguments& arguments,
                                              const TrainingData& data) {
  const TrainingOptions& options = arguments.options;
  const bool linear = options.schedule == LearningRateSchedule::kLinear;
  return {{"data_sha256", data.checksum},
          {"trajectories", fmt::format("{}", data.trajectories)},
          {"train_segments", fmt::format("{}", data.train.examples.size())},
          {"validation_segments", fmt::format("{}", data.validation.examples.size())},
          {"test_segments", fmt::format("{}", data.test.examples.size())},
          {"split_seed", fmt::format("{}", arguments.split_seed)},
          {"inputs", SeenInputs(arguments.inputs)},
          {"width", fmt::format("{}", options.width)},
          {"epochs", fmt::format("{}", options.epochs)},
          {"batch", fmt::format("{}", options.batch)},
          {"learning_rate", fmt::format("{}", options.learning_rate)},
          {"schedule", linear ? "linear" : "constant"},
          {"patience", fmt::format("{}", options.patience)},
          {"seed", fmt::format("{}", options.seed)}};
}

TrainingOutcome OutcomeOf(const TrainArguments& arguments, const TrainingData& data,
                          const TrainingState& state, double seconds) {
  TrainingOutcome outcome;
  outcome.test_loss = LossOf(state.best, data.test, arguments.threads);
  outcome.seconds = seconds;
  NetworkModel& model = outcome.model;
  model.weights = state.best;
  model.inputs = arguments.inputs;
  if (!arguments.any_size) {
    model.rows = data.train.rows;
    model.columns = data.train.columns;
  }
  model.data_origin = data.origin;
  model.version = fmt::format("width {}, {} data {}, seed {}", arguments.options.width, data.origin,
                              data.checksum.substr(0, 8), arguments.options.seed);
  model.learned_from = data.learned_from;
  model.training = SettingsOf(arguments, data);
  model.training["epochs_done"] = fmt::format("{}", state.epochs.size());
  model.training["best_epoch"] = fmt::format("{}", state.best_epoch);
  model.training["stopped"] = StopReason(arguments, state);
  model.training["validation_mbce"] = fmt::format("{:.8f}", BestValidationLoss(state));
  model.training["test_mbce"] = fmt::format("{:.8f}", outcome.test_loss);
  return outcome;
}

std::string CurveTitle(const TrainingOutcome& outcome) {
  return fmt::format("{}: {}", outcome.model.name, outcome.model.version);
}

std::string SummaryText(const TrainArguments& arguments, const TrainingData& data,
                        const TrainingOutcome& outcome, const TrainingState& state) {
  std::string text = fmt::format(
      "data        {} ({}): {} trajectories, {} segments to learn from, {} for validation, {} for "
      "test\n"
      "network     width {}, sees {}\n"
      "trained     {} epochs in {} on {} {} ({})\n"
      "best epoch  {}: MBCE {:.5f} on validation, {:.5f} on test\n"
      "weights     {}  SHA-256 {}\n",
      arguments.data.string(), data.origin, data.trajectories, data.train.examples.size(),
      data.validation.examples.size(), data.test.examples.size(), arguments.options.width,
      SeenInputs(arguments.inputs), state.epochs.size(), DurationText(outcome.seconds),
      arguments.threads, arguments.threads == 1 ? "thread" : "threads",
      StopReason(arguments, state), state.best_epoch, BestValidationLoss(state), outcome.test_loss,
      arguments.out.string(), ChecksumOf(outcome.model));
  if (!arguments.svg.empty()) text += fmt::format("curve       {}\n", arguments.svg.string());
  return text;
}

}  // namespace conav::nhpm
