#pragma once

#include <omp.h>

#include <dnnl.hpp>
#include <memory>
#include <span>
#include <unordered_map>
#include <vector>

#include "nhpm/engine/kernels.h"
#include "nhpm/engine/network_weights.h"

namespace conav::bench {

using nhpm::kInputChannels;
using nhpm::kNetworkLayers;
using nhpm::kOutputChannels;
using Arguments = std::unordered_map<int, dnnl::memory>;
using Tag = dnnl::memory::format_tag;

inline dnnl::memory::desc Floats(const dnnl::memory::dims& dims, Tag tag) {
  return {dims, dnnl::memory::data_type::f32, tag};
}

/// The same network on oneDNN: one thread, its own choice of algorithm and memory layout, ReLU
/// fused, sigmoid at the end. The peer of `conav bench nhpm`.
class OneDnnNetwork {
 public:
  /// `set` bounds the instructions that oneDNN may use, for the rest of the process.
  OneDnnNetwork(const nhpm::NetworkWeights& weights, int rows, int columns,
                nhpm::InstructionSet set) {
    omp_set_num_threads(1);
    if (set == nhpm::InstructionSet::kAvx2) dnnl::set_max_cpu_isa(dnnl::cpu_isa::avx2);
    state_ = std::make_unique<State>(weights, rows, columns);
  }

  /// Input [rows][columns][kInputChannels]; returns probabilities [rows][columns][kOutputChannels],
  /// not masked, valid until the next call.
  std::span<const float> Run(std::span<const float> input) {
    std::copy(input.begin(), input.end(), static_cast<float*>(state_->input.get_data_handle()));
    for (const State::Step& step : state_->steps) {
      step.primitive.execute(state_->stream, step.arguments);
    }
    state_->stream.wait();
    const auto size = static_cast<std::size_t>(state_->rows * state_->columns * kOutputChannels);
    return {static_cast<const float*>(state_->output.get_data_handle()), size};
  }

  static const char* version() {
    static const std::string text = std::to_string(dnnl_version()->major) + "." +
                                    std::to_string(dnnl_version()->minor) + "." +
                                    std::to_string(dnnl_version()->patch);
    return text.c_str();
  }

 private:
  struct State {
    struct Step {
      dnnl::primitive primitive;
      Arguments arguments;
    };

    State(const nhpm::NetworkWeights& weights, int rows, int columns)
        : engine(dnnl::engine::kind::cpu, 0), stream(engine), rows(rows), columns(columns) {
      input = dnnl::memory(Floats({1, kInputChannels, rows, columns}, Tag::nhwc), engine);
      dnnl::memory activation = input;
      for (int layer = 0; layer < kNetworkLayers; ++layer) {
        activation = AddConvolution(weights, layer, activation);
      }
      output = AddSigmoid(activation);
    }

    dnnl::memory Reordered(const dnnl::memory& from, const dnnl::memory::desc& to, bool once) {
      if (from.get_desc() == to) return from;
      dnnl::memory target(to, engine);
      dnnl::reorder reorder(from, target);
      if (once) {
        reorder.execute(stream, const_cast<dnnl::memory&>(from), target);
        stream.wait();
      } else {
        steps.push_back({reorder, {{DNNL_ARG_FROM, from}, {DNNL_ARG_TO, target}}});
      }
      return target;
    }

    dnnl::memory AddConvolution(const nhpm::NetworkWeights& weights, int layer,
                                const dnnl::memory& from) {
      const int inputs = weights.shape.InputsOf(layer);
      const int outputs = weights.shape.OutputsOf(layer);
      const auto index = static_cast<std::size_t>(layer);
      dnnl::memory filter(Floats({outputs, inputs, 3, 3}, Tag::hwio), engine);
      std::copy(weights.weights[index].begin(), weights.weights[index].end(),
                static_cast<float*>(filter.get_data_handle()));
      dnnl::memory bias(Floats({outputs}, Tag::a), engine);
      std::copy(weights.biases[index].begin(), weights.biases[index].end(),
                static_cast<float*>(bias.get_data_handle()));

      dnnl::primitive_attr attributes;
      if (layer < kNetworkLayers - 1) {
        dnnl::post_ops operations;
        operations.append_eltwise(1.0F, dnnl::algorithm::eltwise_relu, 0.0F, 0.0F);
        attributes.set_post_ops(operations);
      }
      const dnnl::convolution_forward::desc description(
          dnnl::prop_kind::forward_inference, dnnl::algorithm::convolution_auto,
          Floats({1, inputs, rows, columns}, Tag::any), Floats({outputs, inputs, 3, 3}, Tag::any),
          Floats({outputs}, Tag::any), Floats({1, outputs, rows, columns}, Tag::any), {1, 1},
          {1, 1}, {1, 1});
      const dnnl::convolution_forward::primitive_desc chosen(description, attributes, engine);
      dnnl::memory to(chosen.dst_desc(), engine);
      steps.push_back({dnnl::convolution_forward(chosen),
                       {{DNNL_ARG_SRC, Reordered(from, chosen.src_desc(), false)},
                        {DNNL_ARG_WEIGHTS, Reordered(filter, chosen.weights_desc(), true)},
                        {DNNL_ARG_BIAS, Reordered(bias, chosen.bias_desc(), true)},
                        {DNNL_ARG_DST, to}}});
      return to;
    }

    dnnl::memory AddSigmoid(const dnnl::memory& from) {
      const dnnl::eltwise_forward::desc description(dnnl::prop_kind::forward_inference,
                                                    dnnl::algorithm::eltwise_logistic,
                                                    from.get_desc(), 0.0F, 0.0F);
      const dnnl::eltwise_forward::primitive_desc chosen(description, engine);
      dnnl::memory to(chosen.dst_desc(), engine);
      steps.push_back({dnnl::eltwise_forward(chosen), {{DNNL_ARG_SRC, from}, {DNNL_ARG_DST, to}}});
      return Reordered(to, Floats({1, kOutputChannels, rows, columns}, Tag::nhwc), false);
    }

    dnnl::engine engine;
    dnnl::stream stream;
    int rows;
    int columns;
    dnnl::memory input;
    dnnl::memory output;
    std::vector<Step> steps;
  };
  std::unique_ptr<State> state_;
};

}  // namespace conav::bench
