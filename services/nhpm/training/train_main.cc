// conav-train: trains the weights of the NHPM on a segment file.
#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>
#include <thread>

#include "common/cli/batch.h"
#include "common/cli/cli.h"
#include "common/cli/progress_line.h"
#include "common/runtime/file.h"
#include "nhpm/training/checkpoint.h"
#include "nhpm/training/train_command.h"

namespace conav::nhpm {
namespace {

constexpr const char* kProgram = "conav train";

constexpr const char* kAbout =
    "Learns how people edit their map from a segment file and writes the weights that conav-nhpm "
    "serves. The defaults are the paper's (Appendix B). It splits the data by trajectory into "
    "training, validation and test, and keeps the weights with the lowest validation "
    "loss.\nAfter a kill or Ctrl-C the same command resumes from OUT.checkpoint and ends with "
    "the same weights. Exit codes: 0 done; 1 failed or stopped; 2 wrong usage.";

/// The file that holds a training's state until it is done.
std::filesystem::path CheckpointPath(const std::filesystem::path& out) {
  std::filesystem::path path = out;
  path += ".checkpoint";
  return path;
}

using Clock = std::chrono::steady_clock;

double SecondsSince(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

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

/// True when training finished or its time is over, false when it was stopped. Writes a checkpoint
/// after each epoch.
Result<bool> RunEpochs(const TrainArguments& arguments, const TrainingData& data, Trainer& trainer,
                       const StopToken& stop) {
  ProgressLine progress;
  const auto settings = SettingsOf(arguments, data);
  const auto start = Clock::now();
  const std::size_t first = trainer.state().epochs.size();
  const auto in_time = [&] {
    return arguments.limit_s == 0.0 || SecondsSince(start) < arguments.limit_s;
  };
  while (!trainer.finished() && (in_time() || trainer.state().epochs.empty())) {
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
        const std::string title = fmt::format("{}: {}", outcome.model.name, outcome.model.version);
        return WriteFile(arguments.svg, LossCurve(state, title, LossName(arguments.options)));
      })
      .and_then(
          [&] { return WriteJsonOutput(arguments.json, ReportJson(arguments, outcome, state)); });
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

/// Trains, or resumes from a checkpoint of `out`; shows progress on standard error, the result on
/// standard output. Exit code: 0 done, 1 failed or stopped (the checkpoint stays).
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
  if (trainer.finished()) std::filesystem::remove(CheckpointPath(arguments.out), ignored);
  if (arguments.json == "-" || arguments.quiet) return 0;
  return ExitCode(kProgram,
                  WriteStandardOutput(SummaryText(arguments, *data, outcome, trainer.state())));
}

struct Flags {
  TrainArguments train;
  AdaptArguments adapt;
  bool adapts = false;
  std::vector<std::string> without;
  std::string model{Name(PerceptionModelKind::kNhpm)};
  std::string schedule = "constant";
  std::string view_encoding = "depth";
  bool no_svg = false;
  std::vector<std::string> sweep;
  Batch batch;
};

/// An option for a whole number from `low` to a million, whose help shows the default.
void AddCount(CLI::App& app, const char* name, int& value, const char* help, int low = 1) {
  AddNumber(app, name, value, help, low, 1000000);
}

void AddNetworkFlags(CLI::App& app, Flags& flags) {
  TrainingOptions& options = flags.train.options;
  app.add_option("--model", flags.model,
                 "nhpm: for mazes; encoder-decoder: for rasters, learns from the maps pasted on a "
                 "canvas; its width is 16, its maximum of epochs 5000, its class weight 338")
      ->capture_default_str()
      ->check(CLI::IsMember(
          {Name(PerceptionModelKind::kNhpm), Name(PerceptionModelKind::kEncoderDecoder)}));
  app.add_option("--width", options.width,
                 "Channels of the hidden layers: 16, 32 or 64; of the first level of an "
                 "encoder-decoder: 4, 8, 16 or 32")
      ->capture_default_str()
      ->check(CLI::IsMember({4, 8, 16, 32, 64}));
  AddNumber(app, "--canvas", options.canvas, "Rows and columns of an encoder-decoder's examples",
            26, 2000);
  app.add_option("--without", flags.without,
                 "Inputs to leave out, for ablations: tau (the path), o (the view), x (the map)")
      ->delimiter(',')
      ->check(CLI::IsMember({"tau", "o", "x"}));
  app.add_option("--view-encoding", flags.view_encoding,
                 "How the network sees a picture: depth (each cell with its nearness), or mask "
                 "(seen or not, as in the paper)")
      ->capture_default_str()
      ->check(CLI::IsMember({"mask", "depth"}));
  app.add_flag("--any-size", flags.train.any_size,
               "Allow the weights for maps of any size, not only the size of the training maps");
}

void AddOptimiserFlags(CLI::App& app, Flags& flags) {
  TrainingOptions& options = flags.train.options;
  AddCount(app, "--epochs", options.epochs, "Maximum number of passes over the data");
  AddCount(app, "--patience", options.patience,
           "Stop after this many epochs without a better validation loss; 0 = never", 0);
  AddCount(app, "--batch", options.batch, "Segments per step");
  AddNumber(app, "--class-weight", options.class_weight, "Weight of edited outputs in the loss",
            1e-3, 1e6);
  AddNumber(app, "--learning-rate", options.learning_rate, "Learning rate of Adam", 1e-9, 10.0);
  app.add_option("--schedule", flags.schedule,
                 "constant, or linear: the learning rate falls to 0 over --epochs")
      ->capture_default_str()
      ->check(CLI::IsMember({"constant", "linear"}));
  AddSeed(app, "--seed", options.seed, "Seed of initial weights, segment order and symmetries");
  AddSeed(app, "--split-seed", flags.train.split_seed,
          "Seed of the split into training, validation and test");
}

void AddFileFlags(CLI::App& app, Flags& flags) {
  TrainArguments& train = flags.train;
  app.add_option("--data", train.data, "Segment file of conav dataset")->required();
  app.add_option("--out", train.out, "Weights file to write; required");
  app.add_option("--json", train.json, "Write the figures to this file, - = standard output");
  auto* svg = app.add_option("--svg", train.svg, "Plot the losses to this file [OUT.svg]");
  app.add_flag("--no-svg", flags.no_svg, "Do not plot the losses")->excludes(svg);
  AddNumber(app, "--limit-s", train.limit_s,
            "End after the epoch in which this many seconds are over and write the best "
            "weights so far; the same command continues; 0 = no limit",
            0.0, 1e9);
  app.add_flag("--fresh", train.fresh, "Ignore OUT.checkpoint and start from the first epoch");
  app.add_flag("--overwrite", train.overwrite,
               "Replace OUT even if it has weights of another training");
  train.threads = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  app.add_option("--threads", train.threads,
                 "Threads [one per core]; the result is the same on any number")
      ->check(Between(1, 256));
}

void AddSweepFlags(CLI::App& app, Flags& flags) {
  app.add_option("--sweep", flags.sweep,
                 "Train once for each value of an option, seed=1..5 or width=16,32; of several, "
                 "for each combination. Prints the validation losses; OUT gets the best weights, "
                 "and --records keeps all")
      ->allow_extra_args(false);
  flags.batch.AddOptions(app, "trainings of --sweep");
}

void AddAdaptFlags(CLI::App& app, Flags& flags) {
  auto* base = app.add_option("--base", flags.adapt.base, "Initial weights file of --adapt");
  auto* adapt = app.add_flag(
      "--adapt", flags.adapts,
      "Fine-tune the last two layers of --base to one participant of the data; cross-validation "
      "chooses strength and length, and the result is never worse there than the base");
  base->needs(adapt);
  adapt->needs(base);
  auto* participant = app.add_option("--participant", flags.adapt.participant,
                                     "The participant of --adapt; optional if there is only one");
  participant->needs(adapt);
}

/// Options that only RunTrain uses.
std::string TrainOnlyFlag(const CLI::App& app) {
  for (const char* flag :
       {"--model", "--width", "--canvas", "--without", "--view-encoding", "--any-size", "--epochs",
        "--patience", "--batch", "--class-weight", "--learning-rate", "--schedule", "--split-seed",
        "--svg", "--no-svg", "--limit-s", "--fresh", "--sweep"}) {
    if (app.count(flag) > 0) return flag;
  }
  return {};
}

/// Reports wrong usage that CLI11 does not detect.
std::string WrongUse(const CLI::App& app, const Flags& flags) {
  if (flags.train.out.empty()) return "--out is required";
  if (flags.sweep.empty() == flags.batch.is_kept()) return "--sweep and --records need each other";
  for (const char* flag : {"--slurm", "--piece"}) {
    if (flags.sweep.empty() && app.count(flag) > 0) return std::string(flag) + " needs --sweep";
  }
  const std::string flag = TrainOnlyFlag(app);
  if (flags.adapts && !flag.empty()) return flag + " excludes --adapt";
  const TrainingOptions& options = flags.train.options;
  if (!IsNetworkWidth(options.width, options.architecture)) {
    return fmt::format("--width {}: model {} has no such width", options.width, flags.model);
  }
  const bool rasters = options.architecture == Architecture::kEncoderDecoder;
  if (rasters && app.count("--view-encoding") > 0) return "--view-encoding needs --model nhpm";
  if (rasters && !flags.without.empty()) return "--without excludes --model encoder-decoder";
  if (!rasters && app.count("--canvas") > 0) return "--canvas needs --model encoder-decoder";
  const std::set<std::string> without(flags.without.begin(), flags.without.end());
  if (without.size() == 3) return "--without tau,o,x: leaves the network no input";
  return {};
}

/// Sets what the command line leaves open to the model's own defaults.
void CompleteModel(const CLI::App& app, Flags& flags) {
  if (flags.model != Name(PerceptionModelKind::kEncoderDecoder)) return;
  TrainingOptions& options = flags.train.options;
  const TrainingOptions defaults = EncoderDecoderOptions();
  options.architecture = defaults.architecture;
  if (app.count("--width") == 0) options.width = defaults.width;
  if (app.count("--epochs") == 0) options.epochs = defaults.epochs;
  if (app.count("--class-weight") == 0) options.class_weight = defaults.class_weight;
}

/// Derives defaults from combinations of flags.
void Complete(Flags& flags) {
  TrainArguments& train = flags.train;
  flags.adapt.data = train.data;
  flags.adapt.out = train.out;
  flags.adapt.json = train.json;
  flags.adapt.overwrite = train.overwrite;
  flags.adapt.threads = train.threads;
  flags.adapt.seed = train.options.seed;
  for (const std::string& name : flags.without) {
    InputOf(train.inputs, name) = false;
  }
  train.inputs.depth = flags.view_encoding == "depth";
  if (flags.schedule == "linear") train.options.schedule = LearningRateSchedule::kLinear;
  if (train.svg.empty() && !flags.no_svg) train.svg = train.out.string() + ".svg";
}

/// Reads the command line. The exit code where there is nothing to do.
std::optional<int> ParseFlags(const std::vector<std::string>& words, Flags& flags) {
  CLI::App app(kAbout, kProgram);
  AddFileFlags(app, flags);
  AddNetworkFlags(app, flags);
  AddOptimiserFlags(app, flags);
  AddSweepFlags(app, flags);
  AddAdaptFlags(app, flags);
  std::vector<const char*> arguments;
  for (const std::string& word : words) arguments.push_back(word.c_str());
  if (const auto ended = Parse(app, static_cast<int>(arguments.size()), arguments.data())) {
    return ended;
  }
  CompleteModel(app, flags);
  const std::string wrong = WrongUse(app, flags);
  if (!wrong.empty()) return Refused(kProgram, wrong);
  Complete(flags);
  return std::nullopt;
}

int Run(const Flags& flags) {
  const StopToken& stop = ProcessStopToken();
  if (flags.adapts) return RunAdapt(flags.adapt, stop);
  if (flags.sweep.empty()) return RunTrain(flags.train, stop);
  const auto train = [&stop](const std::vector<std::string>& words) {
    Flags one;
    if (const auto ended = ParseFlags(words, one)) return *ended;
    one.train.quiet = true;
    return RunTrain(one.train, stop);
  };
  return RunSweep(flags.sweep, flags.train, flags.batch, train);
}

}  // namespace
}  // namespace conav::nhpm

int main(int argc, char** argv) {
  using namespace conav::nhpm;
  Flags flags;
  if (const auto ended = ParseFlags({argv, argv + argc}, flags)) return *ended;
  conav::InstallStopSignals();
  try {
    return Run(flags);
  } catch (const conav::StartupError& error) {
    return conav::Refused(kProgram, error.what());
  }
}
