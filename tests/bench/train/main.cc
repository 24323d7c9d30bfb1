// conav-bench-train: what an epoch of training costs, next to the limit of the cores and libtorch.
#include <fmt/core.h>

#include <algorithm>
#include <thread>

#include "bench/support/bench_program.h"
#include "nhpm/training/trainer.h"
#include "unit/nhpm/training/made_up_examples.h"
#ifdef CONAV_HAVE_TORCH
#include "bench/train/torch_trainer.h"
#endif

namespace conav::bench {
namespace {

constexpr int kGrid = 13;

struct Options {
  int width = 32;
  int examples = 1505;  // paper Appendix A
  int threads = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
};

/// Forward and backward pass, counted as three forward passes.
double FlopsOfEpoch(const Options& options) {
  return 3.0 * FlopsOfPass({options.width}, kGrid * kGrid) * options.examples;
}

Rounds Measure(const BenchProgram& program, const Options& options) {
  // What the examples say does not change what they cost.
  const auto train = nhpm::MadeUpExamples(kGrid, kGrid, options.examples, 1);
  const auto validation = nhpm::MadeUpExamples(kGrid, kGrid, 1, 1);
  nhpm::TrainingOptions training;
  training.width = options.width;
  training.epochs = program.rounds() + 1;
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
  program.ForEachRound([&] {
    const double peak_gflops = MeasureFmaPeakOfThreads(options.threads);
    const double epoch_s = WallSecondsOf([&] { trainer.RunEpoch(stop); });
    rounds.Add({{"epoch_s", epoch_s}});
    if (peak_gflops > 0.0) {  // not without AVX2
      rounds.Add({{"fma_limit_ratio", epoch_s / (1e-9 * FlopsOfEpoch(options) / peak_gflops)}});
    }
#ifdef CONAV_HAVE_TORCH
    const double torch_s = WallSecondsOf([&] { torch.RunEpoch(); });
    rounds.Add({{"libtorch_ratio", epoch_s / torch_s}, {"libtorch_epoch_s", torch_s}});
#endif
  });
  return rounds;
}

void Run(const BenchProgram& program, const Options& options) {
  const Rounds rounds = Measure(program, options);
  const Json metrics = rounds.Medians();
  fmt::print("{}, {} threads, medians of {} rounds, wall time\n", Machine(), options.threads,
             program.rounds());
  fmt::print("epoch of {} random examples 13 x 13, width {}, batch 128\n", options.examples,
             options.width);
  fmt::print("ours      {:7.3f} s", rounds.Median("epoch_s"));
  if (metrics.contains("fma_limit_ratio")) {
    fmt::print(", {:.2f} x the FMA limit of the cores", rounds.Median("fma_limit_ratio"));
  }
  fmt::print("\n");
  if (metrics.contains("libtorch_ratio")) {
    fmt::print("libtorch  {:7.3f} s; ours takes {:.2f} x its time\n",
               rounds.Median("libtorch_epoch_s"), rounds.Median("libtorch_ratio"));
  } else {
    fmt::print("libtorch  not installed when this was built (Debian: libtorch-dev)\n");
  }
  program.Write({{"width", options.width},
                 {"threads", options.threads},
                 {"rounds", program.rounds()},
                 {"metrics", metrics}});
}

}  // namespace
}  // namespace conav::bench

int main(int argc, char** argv) {
  using namespace conav::bench;
  BenchProgram program(
      "conav bench train",
      "Cost of an epoch of training, next to the FMA limit of the cores (three forward passes "
      "an\n"
      "example) and to libtorch where it was installed at build time, in one run.\n"
      "Metrics of --json: epoch_s, fma_limit_ratio (epoch over limit; not without AVX2),\n"
      "libtorch_ratio (ours over libtorch) and libtorch_epoch_s.",
      7);
  Options options;
  AddWidth(program, options.width);
  program.AddNumber("--examples", options.examples, "Examples of an epoch", 1, 1000000);
  program.app()
      .add_option("--threads", options.threads, "Threads [one per core]")
      ->check(conav::Between(1, 256));
  return program.Run(argc, argv, [&] { Run(program, options); });
}
