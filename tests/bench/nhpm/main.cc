// conav-bench-nhpm: what a prediction costs, whole and incremental, next to the core's limit and
// oneDNN.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <stdexcept>

#include "bench/nhpm/onednn_network.h"
#include "bench/nhpm/planner_queries.h"
#include "bench/support/bench_program.h"
#include "nhpm/engine/inference_pass.h"
#include "nhpm/model/encoding.h"
#include "nhpm/model/perception_network.h"

namespace conav::bench {
namespace {

using nhpm::kInputChannels;

constexpr int kGrid = 13;

struct Options {
  int width = 32;
  int episodes = 4;
  nhpm::InstructionSet set = nhpm::AvailableInstructionSets().front();
};

/// Names of --instruction-set.
const std::map<std::string, nhpm::InstructionSet> kSets = {
    {"avx2", nhpm::InstructionSet::kAvx2}, {"avx512", nhpm::InstructionSet::kAvx512}};

/// 0 where there is no FMA to compare with.
int LanesOf(nhpm::InstructionSet set) {
  return set == nhpm::InstructionSet::kAvx512 ? 16 : set == nhpm::InstructionSet::kAvx2 ? 8 : 0;
}

/// Processor time of one of `calls`, microseconds.
double Microseconds(int calls, const std::function<void()>& call) {
  const double seconds = ThreadSecondsOf([&] {
    for (int i = 0; i < calls; ++i) call();
  });
  return 1e6 * seconds / calls;
}

class Benchmark {
 public:
  explicit Benchmark(const Options& options)
      : options_(options),
        model_(MakeModel(options.width)),
        weights_(std::make_shared<const nhpm::PackedWeights>(model_.weights,
                                                             nhpm::PackedWeights::Use::kInference)),
        pass_(weights_, nhpm::KernelsFor(options.width, options.set), kGrid, kGrid),
        onednn_(model_.weights, kGrid, kGrid, options.set),
        batches_(RecordPlannerQueries(options.episodes, 1)),
        input_(static_cast<std::size_t>(kGrid * kGrid) * kInputChannels) {
    for (const auto& batch : batches_) queries_ += batch.size();
    nhpm::EncodeInput(batches_.front().front(), {}, input_);
  }

  /// Largest difference of a probability from oneDNN's: the peer computes the same thing.
  double DifferenceFromOneDnn() {
    const auto ours = pass_.Full(input_);
    const auto theirs = onednn_.Run(input_);
    double worst = 0.0;
    for (std::size_t i = 0; i < ours.size(); ++i) {
      worst = std::max(worst, std::abs(static_cast<double>(nhpm::Sigmoid(ours[i])) -
                                       static_cast<double>(theirs[i])));
    }
    return worst;
  }

  /// Throws unless what is computed incrementally has the bits of whole passes.
  void RequireSameBits() {
    nhpm::PerceptionNetwork network(model_, options_.set);
    for (const auto& batch : batches_) {
      const auto answers = network.Predict(batch);
      for (std::size_t i = 0; i < batch.size(); ++i) {
        if (answers && (*answers)[i] == Whole(batch[i])) continue;
        throw std::runtime_error("an incremental pass has other bits than a whole one");
      }
    }
  }

  /// All in turn, so that they see the same machine.
  void Round(Rounds& rounds) {
    constexpr int kCalls = 50;
    const BeliefGrid& belief = batches_.front().front().belief;
    const double peak_gflops = MeasureFmaPeak(LanesOf(options_.set));
    const double full_us = Microseconds(
        kCalls, [&] { kept_ += nhpm::MaskedAnswer(belief, pass_.Full(input_)).add.values()[20]; });
    const double onednn_us = Microseconds(kCalls, [&] { kept_ += onednn_.Run(input_)[20]; });
    const auto per_query = [&](const std::function<void()>& all) {
      return Microseconds(1, all) / static_cast<double>(queries_);
    };
    const double query_full_us = per_query([&] { AnswerWhole(); });
    const double incremental_us = per_query([&] { AnswerIncrementally(); });
    const double gflops = 1e-3 * flops() / full_us;
    rounds.Add({{"full_us", full_us},
                {"incremental_us", incremental_us},
                {"fma_peak_fraction", peak_gflops > 0.0 ? gflops / peak_gflops : 0.0},
                {"onednn_ratio", onednn_us / full_us},
                {"incremental_speedup", query_full_us / incremental_us},
                {"fma_peak_gflops", peak_gflops},
                {"onednn_us", onednn_us},
                {"query_full_us", query_full_us}});
  }

  double flops() const { return FlopsOfPass(model_.weights.shape, kGrid * kGrid); }
  std::size_t queries() const { return queries_; }
  std::size_t batches() const { return batches_.size(); }

 private:
  static nhpm::NetworkModel MakeModel(int width) {
    nhpm::NetworkModel model;
    model.weights = nhpm::InitialWeights({width}, 1);
    return model;
  }

  PerceptionAnswer Whole(const PerceptionQuery& query) {
    nhpm::EncodeInput(query, {}, input_);
    return nhpm::MaskedAnswer(query.belief, pass_.Full(input_));
  }

  void AnswerWhole() {
    for (const auto& batch : batches_) {
      for (const PerceptionQuery& query : batch) kept_ += ExpectedEdits(Whole(query));
    }
  }

  void AnswerIncrementally() {
    nhpm::PerceptionNetwork network(model_, options_.set);
    for (const auto& batch : batches_) {
      const auto answers = network.Predict(batch);
      for (const PerceptionAnswer& answer : *answers) kept_ += ExpectedEdits(answer);
    }
  }

  Options options_;
  nhpm::NetworkModel model_;
  std::shared_ptr<const nhpm::PackedWeights> weights_;
  nhpm::InferencePass pass_;
  OneDnnNetwork onednn_;
  QueryBatches batches_;
  std::size_t queries_ = 0;
  std::vector<float> input_;
  double kept_ = 0.0;  // so that nothing is optimised away
};

void PrintTable(const Options& options, int count, const Benchmark& benchmark,
                const Rounds& rounds) {
  fmt::print("{}, kernels {}, one thread, medians of {} rounds, processor time\n", Machine(),
             nhpm::KernelsFor(options.width, options.set).name, count);
  fmt::print("network 13 x 13, width {}: {:.2f} MFLOP a sample; weights untrained\n", options.width,
             1e-6 * benchmark.flops());
  fmt::print("full pass            {:8.1f} us  {:5.1f} % of the FMA peak ({:.1f} GFLOP/s)\n",
             rounds.Median("full_us"), 100.0 * rounds.Median("fma_peak_fraction"),
             rounds.Median("fma_peak_gflops"));
  fmt::print("oneDNN {:<13} {:8.1f} us  {:5.2f} x ours\n", OneDnnNetwork::version(),
             rounds.Median("onednn_us"), rounds.Median("onednn_ratio"));
  fmt::print("{} queries of the planner's search, in {} batches, from query to expected edits:\n",
             benchmark.queries(), benchmark.batches());
  fmt::print("  each whole         {:8.1f} us a query\n", rounds.Median("query_full_us"));
  fmt::print("  incremental        {:8.1f} us a query, {:.2f} x as fast, same bits\n",
             rounds.Median("incremental_us"), rounds.Median("incremental_speedup"));
}

void Run(const BenchProgram& program, const Options& options) {
  if (!std::ranges::count(nhpm::AvailableInstructionSets(), options.set)) {
    throw std::runtime_error("this processor does not have the instruction set asked for");
  }
  Benchmark benchmark(options);
  const double difference = benchmark.DifferenceFromOneDnn();
  if (difference > 1e-5) {
    throw std::runtime_error(fmt::format("oneDNN differs by {}", difference));
  }
  benchmark.RequireSameBits();
  Rounds rounds;
  program.ForEachRound([&] { benchmark.Round(rounds); });
  PrintTable(options, program.rounds(), benchmark, rounds);
  program.Write({{"width", options.width},
                 {"kernels", nhpm::KernelsFor(options.width, options.set).name},
                 {"rounds", program.rounds()},
                 {"metrics", rounds.Medians()},
                 {"onednn_difference", difference}});
}

}  // namespace
}  // namespace conav::bench

int main(int argc, char** argv) {
  using namespace conav::bench;
  BenchProgram program(
      "conav bench nhpm",
      "Cost of a prediction of the perception network: a full pass next to the core's FMA peak\n"
      "and to oneDNN, and the planner's queries whole and incremental, all in one run.\n"
      "Metrics of --json: full_us, incremental_us, fma_peak_fraction, onednn_ratio (oneDNN's time\n"
      "over ours), incremental_speedup (whole over incremental), and what they are made of.",
      31);
  Options options;
  AddWidth(program, options.width);
  program.app()
      .add_option("--instruction-set", options.set,
                  "What ours, oneDNN and the peak may use; default: the best of this processor")
      ->transform(CLI::CheckedTransformer(kSets).description("avx2|avx512"));
  program.AddNumber("--episodes", options.episodes, "Episodes whose queries are asked", 1, 100);
  return program.Run(argc, argv, [&] { Run(program, options); });
}
