// conav-bench-nhpm: what a prediction costs, whole and incremental, next to the core's limit and
// oneDNN.
#include <fmt/core.h>
#include <omp.h>

#include <algorithm>
#include <cmath>
#include <dnnl.hpp>
#include <map>
#include <memory>
#include <span>
#include <stdexcept>
#include <unordered_map>

#include "bench/nhpm/planner_queries.h"
#include "bench/support/bench_program.h"
#include "nhpm/engine/encoder_decoder.h"
#include "nhpm/engine/inference_pass.h"
#include "nhpm/model/encoding.h"
#include "nhpm/model/perception_network.h"

namespace conav::bench {
namespace {

using nhpm::kInputChannels;
using nhpm::kNetworkLayers;
using nhpm::kOutputChannels;
using Arguments = std::unordered_map<int, dnnl::memory>;
using Tag = dnnl::memory::format_tag;

dnnl::memory::desc Floats(const dnnl::memory::dims& dims, Tag tag) {
  return {dims, dnnl::memory::data_type::f32, tag};
}

/// The same network on oneDNN: one thread, its own choice of algorithm and memory layout, ReLU
/// fused, sigmoid at the end. The peer of `conav bench nhpm`.
class OneDnnNetwork {
 public:
  /// `set` bounds the instructions that oneDNN may use, for the rest of the process.
  OneDnnNetwork(const nhpm::NetworkWeights& weights, int rows, int columns,
                nhpm::InstructionSet set)
      : engine_(EngineWith(set)), stream_(engine_), rows_(rows), columns_(columns) {
    input_ = dnnl::memory(Floats({1, kInputChannels, rows, columns}, Tag::nhwc), engine_);
    dnnl::memory activation = input_;
    for (int layer = 0; layer < kNetworkLayers; ++layer) {
      activation = AddConvolution(weights, layer, activation);
    }
    output_ = AddSigmoid(activation);
  }

  /// Input [rows][columns][kInputChannels]; returns probabilities [rows][columns][kOutputChannels],
  /// not masked, valid until the next call.
  std::span<const float> Run(std::span<const float> input) {
    std::copy(input.begin(), input.end(), static_cast<float*>(input_.get_data_handle()));
    for (const auto& [primitive, arguments] : steps_) primitive.execute(stream_, arguments);
    stream_.wait();
    const auto size = static_cast<std::size_t>(rows_ * columns_ * kOutputChannels);
    return {static_cast<const float*>(output_.get_data_handle()), size};
  }

  static std::string version() {
    const dnnl_version_t& version = *dnnl_version();
    return fmt::format("{}.{}.{}", version.major, version.minor, version.patch);
  }

 private:
  static dnnl::engine EngineWith(nhpm::InstructionSet set) {
    omp_set_num_threads(1);
    if (set == nhpm::InstructionSet::kAvx2) dnnl::set_max_cpu_isa(dnnl::cpu_isa::avx2);
    return {dnnl::engine::kind::cpu, 0};
  }

  dnnl::memory Reordered(const dnnl::memory& from, const dnnl::memory::desc& to, bool once) {
    if (from.get_desc() == to) return from;
    dnnl::memory target(to, engine_);
    dnnl::reorder reorder(from, target);
    if (once) {
      reorder.execute(stream_, const_cast<dnnl::memory&>(from), target);
      stream_.wait();
    } else {
      steps_.emplace_back(reorder, Arguments{{DNNL_ARG_FROM, from}, {DNNL_ARG_TO, target}});
    }
    return target;
  }

  dnnl::memory Filled(const std::vector<float>& values, const dnnl::memory::desc& layout) {
    dnnl::memory memory(layout, engine_);
    std::copy(values.begin(), values.end(), static_cast<float*>(memory.get_data_handle()));
    return memory;
  }

  dnnl::memory AddConvolution(const nhpm::NetworkWeights& weights, int layer,
                              const dnnl::memory& from) {
    const int inputs = weights.shape.InputsOf(layer);
    const int outputs = weights.shape.OutputsOf(layer);
    const auto index = static_cast<std::size_t>(layer);
    const auto filter = Filled(weights.weights[index], Floats({outputs, inputs, 3, 3}, Tag::hwio));
    const auto bias = Filled(weights.biases[index], Floats({outputs}, Tag::a));
    dnnl::primitive_attr attributes;
    if (layer < kNetworkLayers - 1) {
      dnnl::post_ops operations;
      operations.append_eltwise(1.0F, dnnl::algorithm::eltwise_relu, 0.0F, 0.0F);
      attributes.set_post_ops(operations);
    }
    const dnnl::convolution_forward::desc description(
        dnnl::prop_kind::forward_inference, dnnl::algorithm::convolution_auto,
        Floats({1, inputs, rows_, columns_}, Tag::any), Floats({outputs, inputs, 3, 3}, Tag::any),
        Floats({outputs}, Tag::any), Floats({1, outputs, rows_, columns_}, Tag::any), {1, 1},
        {1, 1}, {1, 1});
    const dnnl::convolution_forward::primitive_desc chosen(description, attributes, engine_);
    dnnl::memory to(chosen.dst_desc(), engine_);
    const auto source = Reordered(from, chosen.src_desc(), false);
    steps_.emplace_back(
        dnnl::convolution_forward(chosen),
        Arguments{{DNNL_ARG_SRC, source},
                  {DNNL_ARG_WEIGHTS, Reordered(filter, chosen.weights_desc(), true)},
                  {DNNL_ARG_BIAS, Reordered(bias, chosen.bias_desc(), true)},
                  {DNNL_ARG_DST, to}});
    return to;
  }

  dnnl::memory AddSigmoid(const dnnl::memory& from) {
    const dnnl::eltwise_forward::desc description(dnnl::prop_kind::forward_inference,
                                                  dnnl::algorithm::eltwise_logistic,
                                                  from.get_desc(), 0.0F, 0.0F);
    const dnnl::eltwise_forward::primitive_desc chosen(description, engine_);
    dnnl::memory to(chosen.dst_desc(), engine_);
    steps_.emplace_back(dnnl::eltwise_forward(chosen),
                        Arguments{{DNNL_ARG_SRC, from}, {DNNL_ARG_DST, to}});
    return Reordered(to, Floats({1, kOutputChannels, rows_, columns_}, Tag::nhwc), false);
  }

  dnnl::engine engine_;
  dnnl::stream stream_;
  int rows_;
  int columns_;
  dnnl::memory input_;
  dnnl::memory output_;
  std::vector<std::pair<dnnl::primitive, Arguments>> steps_;
};

constexpr int kGrid = 13;
constexpr int kRaster = 150;
constexpr nhpm::NetworkShape kRasterShape{16, nhpm::Architecture::kEncoderDecoder};

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
        input_(static_cast<std::size_t>(kGrid * kGrid) * kInputChannels),
        raster_pass_(kRasterShape, kRaster, kRaster, nhpm::EncoderDecoderPass::Use::kInference),
        raster_input_(static_cast<std::size_t>(kRaster * kRaster) * kInputChannels, 0.5F) {
    raster_pass_.SetWeights(
        std::make_shared<const nhpm::NetworkWeights>(nhpm::InitialWeights(kRasterShape, 1)));
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
    const double raster_us =
        Microseconds(5, [&] { kept_ += raster_pass_.Forward(raster_input_)[20]; });
    const double gflops = 1e-3 * flops() / full_us;
    rounds.Add({{"full_us", full_us},
                {"incremental_us", incremental_us},
                {"fma_peak_fraction", peak_gflops > 0.0 ? gflops / peak_gflops : 0.0},
                {"onednn_ratio", onednn_us / full_us},
                {"incremental_speedup", query_full_us / incremental_us},
                {"fma_peak_gflops", peak_gflops},
                {"onednn_us", onednn_us},
                {"query_full_us", query_full_us},
                {"raster_us", raster_us}});
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
  nhpm::EncoderDecoderPass raster_pass_;
  std::vector<float> raster_input_;
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
  fmt::print("encoder-decoder      {:8.1f} us a pass at {} x {}, width {}\n",
             rounds.Median("raster_us"), kRaster, kRaster, kRasterShape.width);
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
      "over ours), incremental_speedup (whole over incremental), and what they are made of; "
      "raster_us\n"
      "(a pass of the encoder-decoder at 150 x 150).",
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
