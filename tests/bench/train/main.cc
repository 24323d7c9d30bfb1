// conav-bench-train: what an epoch of training costs, beside the limit of the cores and libtorch.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <functional>
#include <nlohmann/json.hpp>
#include <thread>

#include "bench/support/bench_program.h"
#include "bench/support/fma_peak.h"
#include "bench/support/measure.h"
#include "common/runtime/random.h"
#include "nhpm/training/trainer.h"
#ifdef CONAV_HAVE_TORCH
#include "bench/train/torch_trainer.h"
#endif

namespace conav::bench {
namespace {

using nhpm::kInputChannels;
using nhpm::kOutputChannels;

constexpr int kGrid = 13;

struct Options {
  int rounds = 7;
  int width = 32;
  int examples = 1505;  // paper Appendix A
  int threads = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
  std::string json;
};

/// Random examples with about one edit each: what they say does not change what they cost.
nhpm::ExampleSet MakeExamples(int count) {
  Random random(1);
  nhpm::ExampleSet set{kGrid, kGrid, {}};
  for (int i = 0; i < count; ++i) {
    nhpm::Example example;
    for (int j = 0; j < kGrid * kGrid * kInputChannels; ++j) {
      example.input.push_back(random.Chance(0.3) ? 1.0F : 0.0F);
    }
    for (int j = 0; j < kGrid * kGrid * kOutputChannels; ++j) {
      const bool edited = random.Chance(1.0 / (kGrid * kGrid));
      example.labels.push_back(random.Chance(0.5) ? nhpm::OutputLabel::kMasked
                               : edited           ? nhpm::OutputLabel::kEdited
                                                  : nhpm::OutputLabel::kKept);
    }
    set.examples.push_back(std::move(example));
  }
  return set;
}

/// Forward and backward pass, counted as three forward passes.
double FlopsOfEpoch(const Options& options) {
  return 3.0 * FlopsOfPass({options.width}, kGrid * kGrid) * options.examples;
}

double WallSeconds(const std::function<void()>& call) {
  const auto start = std::chrono::steady_clock::now();
  call();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

struct Rounds {
  std::vector<double> epoch_s;
  std::vector<double> limit_s;  // empty without AVX2
  std::vector<double> torch_s;  // empty without libtorch
};

Rounds Measure(const Options& options) {
  const nhpm::ExampleSet train = MakeExamples(options.examples);
  const nhpm::ExampleSet validation = MakeExamples(1);
  nhpm::TrainingOptions training;
  training.width = options.width;
  training.epochs = options.rounds + 1;
  training.patience = 0;
  nhpm::Trainer trainer(training, train, validation, options.threads,
                        nhpm::InitialTrainingState(training, nhpm::EditShare(train)));
#ifdef CONAV_HAVE_TORCH
  TorchTrainer torch(options.width, training.batch, options.threads, train);
  torch.RunEpoch();
#endif
  const StopToken stop;
  trainer.RunEpoch(stop);  // warms up
  Rounds rounds;
  for (int i = 0; i < options.rounds; ++i) {
    ShowRound(i, options.rounds);
    const double peak_gflops = MeasureFmaPeakOfThreads(options.threads);
    if (peak_gflops > 0.0) rounds.limit_s.push_back(1e-9 * FlopsOfEpoch(options) / peak_gflops);
    rounds.epoch_s.push_back(WallSeconds([&] { trainer.RunEpoch(stop); }));
#ifdef CONAV_HAVE_TORCH
    rounds.torch_s.push_back(WallSeconds([&] { torch.RunEpoch(); }));
#endif
  }
  return rounds;
}

void Run(const Options& options) {
  const Rounds rounds = Measure(options);
  nlohmann::ordered_json metrics{{"epoch_s", Median(rounds.epoch_s)}};
  if (!rounds.limit_s.empty()) {
    metrics["fma_limit_ratio"] = MedianRatio(rounds.epoch_s, rounds.limit_s);
  }
  if (!rounds.torch_s.empty()) {
    metrics["libtorch_ratio"] = MedianRatio(rounds.epoch_s, rounds.torch_s);
    metrics["libtorch_epoch_s"] = Median(rounds.torch_s);
  }
  const auto value = [&](const char* name) { return metrics[name].get<double>(); };
  fmt::print("{}, {} threads, medians of {} rounds, wall time\n", Machine(), options.threads,
             options.rounds);
  fmt::print("epoch of {} random examples 13 x 13, width {}, batch 128\n", options.examples,
             options.width);
  fmt::print("ours      {:7.3f} s", value("epoch_s"));
  if (!rounds.limit_s.empty()) {
    fmt::print(", {:.2f} x the FMA limit of the cores", value("fma_limit_ratio"));
  }
  fmt::print("\n");
  if (rounds.torch_s.empty()) {
    fmt::print("libtorch  not installed when this was built (Debian: libtorch-dev)\n");
  } else {
    fmt::print("libtorch  {:7.3f} s; ours takes {:.2f} x its time\n", value("libtorch_epoch_s"),
               value("libtorch_ratio"));
  }
  WriteFigures(options.json, {{"benchmark", "train"},
                              {"machine", Machine()},
                              {"width", options.width},
                              {"threads", options.threads},
                              {"rounds", options.rounds},
                              {"metrics", metrics}});
}

}  // namespace
}  // namespace conav::bench

using namespace conav::bench;

int main(int argc, char** argv) {
  CLI::App app(
      "What an epoch of training costs, beside the FMA limit of the cores (three forward passes "
      "an\n"
      "example) and beside libtorch where it was installed at build time, in one run.\n"
      "Metrics of --json: epoch_s, fma_limit_ratio (epoch over limit; not without AVX2),\n"
      "libtorch_ratio (ours over libtorch) and libtorch_epoch_s.",
      "conav bench train");
  Options options;
  AddUsualOptions(app, options.json, options.rounds);
  app.add_option("--width", options.width, "Channels of the hidden layers")
      ->capture_default_str()
      ->check(CLI::IsMember({16, 32, 64}));
  AddNumber(app, "--examples", options.examples, "Examples of an epoch", {1, 1000000});
  app.add_option("--threads", options.threads, "Threads [one per core]")->check(CLI::Range(1, 256));
  return RunBenchmark(app, argc, argv, [&] { Run(options); });
}
