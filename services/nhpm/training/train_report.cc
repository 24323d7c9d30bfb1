#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "common/cli/progress_line.h"
#include "common/plot/axes.h"
#include "nhpm/model/encoding.h"
#include "nhpm/training/checkpoint.h"
#include "nhpm/training/train_command.h"

namespace conav::nhpm {

Result<void> CheckReplaceable(const std::filesystem::path& out,
                              const std::map<std::string, std::string>& settings) {
  const auto finished = ReadWeightsFile(out);
  if (!finished && finished.error().code == ErrorCode::kNotFound) return {};
  if (!finished) {
    return Fail(ErrorCode::kRefused,
                fmt::format("{}; --overwrite replaces it", finished.error().text));
  }
  std::map<std::string, std::string> there;
  for (const auto& [name, value] : finished->training) {
    const bool of_adapting = std::ranges::find(kAdaptSettings, name) != std::end(kAdaptSettings);
    if (of_adapting || settings.contains(name)) there[name] = value;
  }
  const std::string difference = DifferenceText(there, settings);
  if (difference.empty()) return {};
  return Fail(ErrorCode::kRefused, fmt::format("{} holds weights of another training: {}; "
                                               "--overwrite replaces them",
                                               out.string(), difference));
}

namespace {

constexpr double kWidth = 760.0;
constexpr double kHeight = 420.0;
constexpr double kLeft = 76.0;
constexpr double kRight = 24.0;
constexpr double kTop = 56.0;
constexpr double kBottom = 52.0;
constexpr const char* kTrainColour = "#1b6ca8";
constexpr const char* kValidationColour = "#c2541b";

/// Epochs from left to right, losses on a logarithmic scale.
PlotArea AreaOf(const std::vector<EpochReport>& epochs) {
  double low = 1e9;
  double high = 1e-12;
  for (const EpochReport& epoch : epochs) {
    for (const double loss : {epoch.train_loss, epoch.validation_loss}) {
      low = std::min(low, std::max(loss, 1e-12));
      high = std::max(high, loss);
    }
  }
  const double last = std::max(2.0, static_cast<double>(epochs.size()));
  return {{kLeft, kTop},
          kWidth - kLeft - kRight,
          kHeight - kTop - kBottom,
          {0.0, last, std::ceil(last / 8.0)},
          {.low = low / 1.1, .high = 1.1 * high, .scale = Scale::kLogarithmic},
          kDocumentPlotStyle};
}

void DrawLoss(SvgCanvas& canvas, const PlotArea& area, const std::vector<EpochReport>& epochs,
              double EpochReport::*loss, const char* colour) {
  std::vector<PixelPosition> line;
  for (const EpochReport& epoch : epochs) line.push_back(area.At(epoch.epoch, epoch.*loss));
  if (line.size() == 1) line.push_back({line[0].x + 4, line[0].y});
  canvas.Polyline(line, fmt::format("stroke=\"{}\" stroke-width=\"1.8\"", colour));
}

void DrawLegend(SvgCanvas& canvas, const TrainingState& state, const std::string& loss) {
  const double x = kWidth - kRight - 250;
  canvas.Line({x, kTop + 6}, {x + 22, kTop + 6},
              fmt::format("stroke=\"{}\" stroke-width=\"3\"", kTrainColour));
  canvas.Text({x + 30, kTop + 10}, loss + ", training", kDocumentPlotStyle.label);
  canvas.Line({x, kTop + 26}, {x + 22, kTop + 26},
              fmt::format("stroke=\"{}\" stroke-width=\"3\"", kValidationColour));
  canvas.Text({x + 30, kTop + 30},
              fmt::format("{}, validation (best {:.5f}, epoch {})", loss, BestValidationLoss(state),
                          state.best_epoch),
              kDocumentPlotStyle.label);
}

double TestLoss(const TrainArguments& arguments, const TrainingData& data,
                const NetworkWeights& weights) {
  const auto pass =
      MakeBatchPass(arguments.options, data.test.rows, data.test.columns, arguments.threads);
  return pass->MeanLoss(TrainingWeights(weights), data.test.examples);
}

bool IsEncoderDecoder(const TrainingOptions& options) {
  return options.architecture == Architecture::kEncoderDecoder;
}

const char* StopReason(const TrainArguments& arguments, const TrainingState& state) {
  const TrainingOptions& options = arguments.options;
  const int epochs = static_cast<int>(state.epochs.size());
  if (epochs >= options.epochs) return "all epochs done";
  const bool better = options.patience == 0 || epochs - state.best_epoch < options.patience;
  return better ? "time limit" : "no better validation loss";
}

nlohmann::ordered_json ToJson(const EpochReport& epoch) {
  return {{"epoch", epoch.epoch},
          {"train_mbce", epoch.train_loss},
          {"validation_mbce", epoch.validation_loss}};
}

}  // namespace

std::string LossName(const TrainingOptions& options) {
  if (options.class_weight == 1.0) return "MBCE";
  return fmt::format("BCE, edits x {}", options.class_weight);
}

std::string LossCurve(const TrainingState& state, const std::string& title,
                      const std::string& loss) {
  DEMAND(!state.epochs.empty());
  const PlotArea area = AreaOf(state.epochs);
  SvgCanvas canvas;
  canvas.Text({kLeft, 30}, title, "font-size=\"16\" fill=\"#000000\"");
  area.Draw(canvas, "epoch", "");
  DrawLoss(canvas, area, state.epochs, &EpochReport::train_loss, kTrainColour);
  DrawLoss(canvas, area, state.epochs, &EpochReport::validation_loss, kValidationColour);
  canvas.Circle(area.At(state.best_epoch, BestValidationLoss(state)), 4.5,
                fmt::format("fill=\"{}\"", kValidationColour));
  DrawLegend(canvas, state, loss);
  return canvas.Document(kWidth, kHeight, title);
}

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
  std::map<std::string, std::string> settings{
      {"data_sha256", data.checksum},
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
  if (options.class_weight != 1.0) {
    settings["class_weight"] = fmt::format("{}", options.class_weight);
  }
  if (IsEncoderDecoder(options)) {
    settings["model"] = Name(PerceptionModelKind::kEncoderDecoder);
    settings["canvas"] = fmt::format("{}", options.canvas);
  }
  return settings;
}

TrainingOutcome OutcomeOf(const TrainArguments& arguments, const TrainingData& data,
                          const TrainingState& state, double seconds) {
  TrainingOutcome outcome;
  const TrainingOptions& options = arguments.options;
  outcome.test_loss = TestLoss(arguments, data, state.best);
  outcome.seconds = seconds;
  NetworkModel& model = outcome.model;
  model.weights = state.best;
  for (float& bias : model.weights.biases.back()) {
    bias -= static_cast<float>(std::log(options.class_weight));
  }
  model.inputs = arguments.inputs;
  if (IsEncoderDecoder(options)) {
    model.name = Name(PerceptionModelKind::kEncoderDecoder);
  } else if (!arguments.any_size) {
    model.rows = data.train.rows;
    model.columns = data.train.columns;
  }
  model.data_origin = data.origin;
  model.version = fmt::format("width {}, {} data {}, seed {}", options.width, data.origin,
                              data.checksum.substr(0, 8), options.seed);
  model.learned_from = data.learned_from;
  model.training = SettingsOf(arguments, data);
  model.training["epochs_done"] = fmt::format("{}", state.epochs.size());
  model.training["best_epoch"] = fmt::format("{}", state.best_epoch);
  model.training["stopped"] = StopReason(arguments, state);
  model.training["validation_mbce"] = fmt::format("{:.8f}", BestValidationLoss(state));
  model.training["test_mbce"] = fmt::format("{:.8f}", outcome.test_loss);
  return outcome;
}

std::string SummaryText(const TrainArguments& arguments, const TrainingData& data,
                        const TrainingOutcome& outcome, const TrainingState& state) {
  std::string text = fmt::format(
      "data        {} ({}): {} trajectories, {} segments to learn from, {} for validation, {} for "
      "test\n"
      "network     {}width {}, sees {}\n"
      "trained     {} epochs in {} on {} {} ({})\n"
      "best epoch  {}: {} {:.5f} on validation, {:.5f} on test\n"
      "weights     {}  SHA-256 {}\n",
      arguments.data.string(), data.origin, data.trajectories, data.train.examples.size(),
      data.validation.examples.size(), data.test.examples.size(),
      IsEncoderDecoder(arguments.options) ? "encoder-decoder, " : "", arguments.options.width,
      SeenInputs(arguments.inputs), state.epochs.size(), DurationText(outcome.seconds),
      arguments.threads, arguments.threads == 1 ? "thread" : "threads",
      StopReason(arguments, state), state.best_epoch, LossName(arguments.options),
      BestValidationLoss(state), outcome.test_loss, arguments.out.string(),
      ChecksumOf(outcome.model));
  if (!arguments.svg.empty()) text += fmt::format("curve       {}\n", arguments.svg.string());
  return text;
}

}  // namespace conav::nhpm
