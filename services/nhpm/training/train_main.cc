#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "common/cli/cli.h"
#include "common/runtime/threads.h"
#include "nhpm/model/encoding.h"
#include "nhpm/training/train_command.h"

// conav-train: trains the weights of the NHPM on a segment file.

namespace {

using conav::nhpm::LearningRateSchedule;
using conav::nhpm::TrainArguments;
using conav::nhpm::TrainingOptions;

struct Flags {
  TrainArguments train;
  conav::nhpm::AdaptArguments adapt;
  bool adapts = false;
  std::vector<std::string> without;
  std::string schedule = "constant";
  bool no_svg = false;
};

void AddNetworkFlags(CLI::App& app, Flags& flags) {
  TrainingOptions& options = flags.train.options;
  app.add_option("--width", options.width, "Channels of the hidden layers")
      ->capture_default_str()
      ->check(CLI::IsMember({16, 32, 64}));
  app.add_option("--without", flags.without,
                 "Inputs to leave out, for ablations: tau (the path), o (the view), x (the map)")
      ->delimiter(',')
      ->check(CLI::IsMember({"tau", "o", "x"}));
  app.add_flag("--any-size", flags.train.any_size,
               "Allow the weights for maps of any size, not only the size of the training maps");
}

void AddOptimiserFlags(CLI::App& app, Flags& flags) {
  TrainingOptions& options = flags.train.options;
  app.add_option("--epochs", options.epochs, "Maximum number of passes over the data")
      ->capture_default_str()
      ->check(CLI::Range(1, 1000000));
  app.add_option("--patience", options.patience,
                 "Stop after this many epochs without a better validation loss; 0 = never")
      ->capture_default_str()
      ->check(CLI::Range(0, 1000000));
  app.add_option("--batch", options.batch, "Segments per step")
      ->capture_default_str()
      ->check(CLI::Range(1, 1000000));
  app.add_option("--learning-rate", options.learning_rate, "Learning rate of Adam")
      ->capture_default_str()
      ->check(CLI::Range(1e-9, 10.0));  // Range accepts nan: see WrongUse
  app.add_option("--schedule", flags.schedule,
                 "constant, or linear: the learning rate falls to 0 over --epochs")
      ->capture_default_str()
      ->check(CLI::IsMember({"constant", "linear"}));
  app.add_option("--seed", options.seed, "Seed of initial weights, segment order and symmetries")
      ->check(conav::WholeNumber())
      ->capture_default_str();
  app.add_option("--split-seed", flags.train.split_seed,
                 "Seed of the split into training, validation and test")
      ->check(conav::WholeNumber())
      ->capture_default_str();
}

void AddFileFlags(CLI::App& app, Flags& flags) {
  TrainArguments& train = flags.train;
  app.add_option("--data", train.data, "Segment file of conav dataset")->required();
  app.add_option("--out", train.out, "Weights file to write; required except with --each");
  app.add_option("--json", train.json, "Write the figures to this file, - = standard output");
  auto* svg = app.add_option("--svg", train.svg, "Plot the losses to this file [OUT.svg]");
  app.add_flag("--no-svg", flags.no_svg, "Do not plot the losses")->excludes(svg);
  app.add_flag("--fresh", train.fresh, "Ignore OUT.checkpoint and start from the first epoch");
  app.add_flag("--overwrite", train.overwrite,
               "Replace OUT even if it has weights of another training");
  train.threads = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  app.add_option("--threads", train.threads,
                 "Threads [one per core]; the result is the same on any number")
      ->check(CLI::Range(1, 256));
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
  auto* each = app.add_flag(
      "--each", flags.adapt.each,
      "With --adapt: print for each participant what adapting to half of the trajectories "
      "gains on the other half; writes no weights");
  each->needs(adapt)->excludes(participant);
  app.add_option("--general", flags.adapt.general,
                 "With --each: segments of everybody that the base never saw; prints what adapting "
                 "loses on them")
      ->needs(each);
  participant->needs(adapt);
}

/// Options that only RunTrain uses.
std::string TrainOnlyFlag(const CLI::App& app) {
  for (const char* flag :
       {"--width", "--without", "--any-size", "--epochs", "--patience", "--batch",
        "--learning-rate", "--schedule", "--split-seed", "--svg", "--no-svg", "--fresh"}) {
    if (app.count(flag) > 0) return flag;
  }
  return {};
}

/// Reports wrong usage that CLI11 does not detect.
std::string WrongUse(const CLI::App& app, const Flags& flags) {
  const bool writes = !flags.adapt.each;
  if (writes && flags.train.out.empty()) return "--out is required";
  if (!writes && !flags.train.out.empty()) return "--each writes no weights: no --out";
  const std::string flag = TrainOnlyFlag(app);
  if (flags.adapts && !flag.empty()) return flag + " excludes --adapt";
  if (std::isnan(flags.train.options.learning_rate)) return "--learning-rate is not a number";
  const std::set<std::string> without(flags.without.begin(), flags.without.end());
  if (without.size() == 3) return "--without tau,o,x: leaves the network no input";
  return {};
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
    conav::nhpm::InputOf(train.inputs, name) = false;
  }
  if (flags.schedule == "linear") train.options.schedule = LearningRateSchedule::kLinear;
  if (train.svg.empty() && !flags.no_svg) train.svg = train.out.string() + ".svg";
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(
      "Learns how people edit their map from a segment file and writes the weights that conav-nhpm "
      "serves. The defaults are the paper's (Appendix B). It splits the data by trajectory into "
      "training, validation and test, and keeps the weights with the lowest validation "
      "loss.\nAfter a kill or Ctrl-C the same command resumes from OUT.checkpoint and ends with "
      "the same weights. Exit codes: 0 done; 1 failed or stopped; 2 wrong usage.",
      "conav train");
  Flags flags;
  AddFileFlags(app, flags);
  AddNetworkFlags(app, flags);
  AddOptimiserFlags(app, flags);
  AddAdaptFlags(app, flags);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  if (const std::string wrong = WrongUse(app, flags); !wrong.empty()) {
    fmt::print(stderr, "conav train: {}\n", wrong);
    return 2;
  }
  Complete(flags);
  conav::InstallStopSignals();
  if (flags.adapts) return conav::nhpm::RunAdapt(flags.adapt, conav::ProcessStopToken());
  return conav::nhpm::RunTrain(flags.train, conav::ProcessStopToken());
}
