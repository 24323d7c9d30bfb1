#include "nhpm/training/train_command.h"

#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <nlohmann/json.hpp>

#include "common/cli/cli.h"
#include "common/cli/progress_line.h"
#include "common/runtime/file.h"
#include "nhpm/model/weights_file.h"
#include "nhpm/training/checkpoint.h"
#include "nhpm/training/example.h"
#include "nhpm/training/train_report.h"

namespace conav::nhpm {
namespace {

using Clock = std::chrono::steady_clock;

double SecondsSince(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

constexpr const char* kProgram = "conav train";

/// The initial state. Errors: kRefused when the checkpoint belongs to another training.
Result<TrainingState> FirstState(const TrainArguments& arguments, const TrainingData& data) {
  const std::filesystem::path path = CheckpointPath(arguments.out);
  const TrainingState initial = InitialTrainingState(arguments.options, EditShare(data.train));
  if (arguments.fresh) return initial;
  auto checkpoint = ReadCheckpoint(path);
  if (!checkpoint && checkpoint.error().code == ErrorCode::kNotFound) return initial;
  if (!checkpoint) {
    return Fail(checkpoint.error().code,
                fmt::format("{}; --fresh ignores it", checkpoint.error().text));
  }
  const std::string difference = DifferenceText(checkpoint->settings, SettingsOf(arguments, data));
  if (!difference.empty()) {
    return Fail(ErrorCode::kRefused,
                fmt::format("{} belongs to another training: {}; --fresh ignores it", path.string(),
                            difference));
  }
  fmt::print(stderr, "resuming from {} after epoch {}\n", path.string(),
             checkpoint->state.epochs.size());
  return std::move(checkpoint->state);
}

std::string ProgressText(const TrainingOptions& options, const TrainingState& state, double seconds,
                         double seconds_per_epoch) {
  const EpochReport& last = state.epochs.back();
  return fmt::format(
      "epoch {:>3}/{}  train {:.5f}  validation {:.5f}  best {:.5f} (epoch {})  {:.2f} s  "
      "at most {} left",
      last.epoch, options.epochs, last.train_loss, last.validation_loss, BestValidationLoss(state),
      state.best_epoch, seconds, DurationText(seconds_per_epoch * (options.epochs - last.epoch)));
}

Result<void> CheckFinite(const EpochReport& report) {
  if (std::isfinite(report.train_loss) && std::isfinite(report.validation_loss)) return {};
  return Fail(ErrorCode::kOutOfRange,
              fmt::format("the loss is not finite after epoch {}; a smaller --learning-rate may "
                          "help",
                          report.epoch));
}

/// True when training finished, false when it was stopped. Writes a checkpoint after each epoch.
Result<bool> RunEpochs(const TrainArguments& arguments, const TrainingData& data, Trainer& trainer,
                       const StopToken& stop) {
  ProgressLine progress;
  const auto settings = SettingsOf(arguments, data);
  const auto start = Clock::now();
  const std::size_t first = trainer.state().epochs.size();
  while (!trainer.finished()) {
    const auto epoch_start = Clock::now();
    const auto report = trainer.RunEpoch(stop);
    if (!report) return false;
    const auto kept = CheckFinite(*report).and_then([&] {
      return WriteCheckpoint(CheckpointPath(arguments.out), {settings, trainer.state()});
    });
    if (!kept) return tl::unexpected(kept.error());
    const std::size_t done = trainer.state().epochs.size();
    progress.Show(ProgressText(arguments.options, trainer.state(), SecondsSince(epoch_start),
                               SecondsSince(start) / static_cast<double>(done - first)));
  }
  return true;
}

Result<void> WriteOutputs(const TrainArguments& arguments, const TrainingOutcome& outcome,
                          const TrainingState& state) {
  return WriteWeightsFile(arguments.out, outcome.model)
      .and_then([&]() -> Result<void> {
        if (arguments.svg.empty()) return {};
        return WriteFile(arguments.svg, LossCurve(state, CurveTitle(outcome)));
      })
      .and_then([&]() -> Result<void> {
        return WriteJsonOutput(arguments.json, ReportJson(arguments, outcome, state));
      });
}

int CheckTrainFiles(const TrainArguments& arguments) {
  const int code = CheckFiles(kProgram, {{"--data", arguments.data}},
                              {{"--out", arguments.out},
                               {"the checkpoint", CheckpointPath(arguments.out)},
                               {"--json", arguments.json},
                               {"--svg", arguments.svg}});
  std::error_code ignored;
  const auto status = std::filesystem::status(arguments.out, ignored);
  if (code != 0 || !std::filesystem::exists(status) || std::filesystem::is_regular_file(status)) {
    return code;
  }
  return Failed(kProgram,
                {ErrorCode::kIo, fmt::format("--out {}: is a device, which stores nothing",
                                             arguments.out.string())});
}

int Stopped(const TrainArguments& arguments, const TrainingState& state) {
  fmt::print(stderr, "conav train: stopped after epoch {}; the same command resumes from {}\n",
             state.epochs.size(), CheckpointPath(arguments.out).string());
  return 1;
}

}  // namespace

std::filesystem::path CheckpointPath(const std::filesystem::path& out) {
  std::filesystem::path path = out;
  path += ".checkpoint";
  return path;
}

int RunTrain(const TrainArguments& arguments, const StopToken& stop) {
  const auto start = Clock::now();
  // Check before an hour of training, not after it.
  if (const int code = CheckTrainFiles(arguments); code != 0) return code;
  const auto data = LoadTrainingData(arguments.data, arguments.inputs, arguments.split_seed);
  if (!data) return Failed(kProgram, data.error());
  if (!arguments.overwrite) {
    const auto replaceable = CheckReplaceable(arguments.out, SettingsOf(arguments, *data));
    if (!replaceable) return Failed(kProgram, replaceable.error());
  }
  auto state = FirstState(arguments, *data);
  if (!state) return Failed(kProgram, state.error());
  Trainer trainer(arguments.options, data->train, data->validation, arguments.threads,
                  std::move(*state));
  const auto finished = RunEpochs(arguments, *data, trainer, stop);
  if (!finished) return Failed(kProgram, finished.error());
  if (!*finished) return Stopped(arguments, trainer.state());
  const TrainingOutcome outcome = OutcomeOf(arguments, *data, trainer.state(), SecondsSince(start));
  if (const auto written = WriteOutputs(arguments, outcome, trainer.state()); !written) {
    return Failed(kProgram, written.error());
  }
  std::error_code ignored;
  std::filesystem::remove(CheckpointPath(arguments.out), ignored);
  if (arguments.json == "-") return 0;
  return ExitCode(kProgram,
                  WriteStandardOutput(SummaryText(arguments, *data, outcome, trainer.state())));
}

}  // namespace conav::nhpm
