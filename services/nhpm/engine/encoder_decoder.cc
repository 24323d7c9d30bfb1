#include "nhpm/engine/encoder_decoder.h"

#include <omp.h>

#include <algorithm>
#include <dnnl.hpp>
#include <optional>
#include <unordered_map>

#include "common/runtime/result.h"

namespace conav::nhpm {
namespace {

using Tag = dnnl::memory::format_tag;
using Arguments = std::unordered_map<int, dnnl::memory>;
using Use = EncoderDecoderPass::Use;

dnnl::memory::desc Floats(const dnnl::memory::dims& dims, Tag tag) {
  return {dims, dnnl::memory::data_type::f32, tag};
}

std::span<float> Values(const dnnl::memory& memory) {
  return {static_cast<float*>(memory.get_data_handle()),
          memory.get_desc().get_size() / sizeof(float)};
}

/// While it lives, oneDNN works on the calling thread alone.
class OnThisThread {
 public:
  OnThisThread() { omp_set_num_threads(1); }
  ~OnThisThread() { omp_set_num_threads(before_); }
  OnThisThread(const OnThisThread&) = delete;
  OnThisThread& operator=(const OnThisThread&) = delete;

 private:
  int before_ = omp_get_max_threads();
};

bool Halves(int layer) { return layer == 1 || layer == 3 || layer == 5; }
bool Upsamples(int layer) { return layer == 7 || layer == 9 || layer == 11; }

/// Calls visit(index in small, index in large) for each pixel of the large one.
template <class Visit>
void ForEachUpsampled(LayerSize small, LayerSize large, Visit visit) {
  for (int row = 0; row < large.rows; ++row) {
    const int from_row = UpsamplingSource(row, small.rows, large.rows);
    for (int column = 0; column < large.columns; ++column) {
      const int from_column = UpsamplingSource(column, small.columns, large.columns);
      visit(std::ptrdiff_t{from_row} * small.columns + from_column,
            std::ptrdiff_t{row} * large.columns + column);
    }
  }
}

void Upsample(LayerSize small, LayerSize large, int channels, const float* from, float* to) {
  ForEachUpsampled(small, large, [&](std::ptrdiff_t source, std::ptrdiff_t target) {
    std::copy_n(from + source * channels, channels, to + target * channels);
  });
}

/// The gradient of Upsample: each source gets the sum of its targets' gradients.
void SumUpsampled(LayerSize small, LayerSize large, int channels, const float* from, float* to) {
  std::fill_n(to, std::ptrdiff_t{small.rows} * small.columns * channels, 0.0F);
  ForEachUpsampled(small, large, [&](std::ptrdiff_t target, std::ptrdiff_t source) {
    const float* values = from + source * channels;
    float* sums = to + target * channels;
    for (int i = 0; i < channels; ++i) sums[i] += values[i];
  });
}

/// Turns the gradient after a ReLU into the one before it.
void MaskGradient(std::span<const float> activation, std::span<float> gradient) {
  for (std::size_t i = 0; i < gradient.size(); ++i) {
    gradient[i] = activation[i] > 0.0F ? gradient[i] : 0.0F;
  }
}

/// A convolution as oneDNN sees it: channels last, weights in any order.
struct Geometry {
  dnnl::memory::desc source, weights, bias, destination;
  dnnl::memory::dims strides, padding, end_padding;
};

/// The padding after the last row or column that makes `out` exact; 1 before the first.
int EndPadding(int in, int out, int stride) { return (out - 1) * stride + 2 - in; }

Geometry GeometryOf(NetworkShape shape, int layer, LayerSize in, LayerSize out) {
  const int inputs = shape.InputsOf(layer);
  const int outputs = shape.OutputsOf(layer);
  const int stride = Halves(layer) ? 2 : 1;
  return {Floats({1, inputs, in.rows, in.columns}, Tag::nhwc),
          Floats({outputs, inputs, 3, 3}, Tag::any),
          Floats({outputs}, Tag::a),
          Floats({1, outputs, out.rows, out.columns}, Tag::nhwc),
          {stride, stride},
          {1, 1},
          {EndPadding(in.rows, out.rows, stride), EndPadding(in.columns, out.columns, stride)}};
}

constexpr auto kAlgorithm = dnnl::algorithm::convolution_direct;

dnnl::convolution_forward::primitive_desc ForwardOf(const Geometry& g, bool relu,
                                                    const dnnl::engine& engine) {
  const dnnl::convolution_forward::desc description(dnnl::prop_kind::forward_training, kAlgorithm,
                                                    g.source, g.weights, g.bias, g.destination,
                                                    g.strides, g.padding, g.end_padding);
  dnnl::primitive_attr attributes;
  if (relu) {
    dnnl::post_ops operations;
    operations.append_eltwise(1.0F, dnnl::algorithm::eltwise_relu, 0.0F, 0.0F);
    attributes.set_post_ops(operations);
  }
  return {description, attributes, engine};
}

}  // namespace

std::vector<LayerSize> EncoderDecoderSizes(int rows, int columns) {
  std::vector<LayerSize> sizes;
  LayerSize size{rows, columns};
  for (int layer = 0; layer < kEncoderDecoderLayers; ++layer) {
    if (Halves(layer)) size = {(size.rows + 1) / 2, (size.columns + 1) / 2};
    if (Upsamples(layer)) size = sizes[static_cast<std::size_t>(11 - layer)];
    sizes.push_back(size);
  }
  return sizes;
}

struct EncoderDecoderPass::Network {
  /// A layer's primitives with what they read and write.
  struct Layer {
    LayerSize in, out;
    int inputs = 0;
    dnnl::memory source;       // of this layer, or the output of the one before
    dnnl::memory destination;  // after the ReLU
    dnnl::memory weights, bias;
    dnnl::convolution_forward forward;
    // For training:
    dnnl::memory back_weights;
    dnnl::memory source_gradient, destination_gradient, weight_gradient, bias_gradient;
    dnnl::memory plain_gradient;  // as weight_gradient, in the order of NetworkWeights
    std::optional<dnnl::convolution_backward_data> to_source;  // not in the first layer
    dnnl::convolution_backward_weights to_weights;
  };

  Network(NetworkShape shape, int rows, int columns, Use use)
      : shape(shape), use(use), engine(dnnl::engine::kind::cpu, 0), stream(engine) {
    const OnThisThread guard;
    const std::vector<LayerSize> sizes = EncoderDecoderSizes(rows, columns);
    LayerSize before{rows, columns};
    for (int layer = 0; layer < shape.layers(); ++layer) {
      const LayerSize out = sizes[static_cast<std::size_t>(layer)];
      AddLayer(layer, before, out);
      before = out;
    }
  }

  void AddLayer(int layer, LayerSize before, LayerSize out) {
    Layer& l = layers.emplace_back();
    l.in = Upsamples(layer) ? out : before;
    l.out = out;
    l.inputs = shape.InputsOf(layer);
    const Geometry geometry = GeometryOf(shape, layer, l.in, l.out);
    const auto forward = ForwardOf(geometry, layer < shape.layers() - 1, engine);
    const bool own = layer == 0 || Upsamples(layer);
    l.source = own ? dnnl::memory(geometry.source, engine) : layers[layers.size() - 2].destination;
    l.destination = dnnl::memory(geometry.destination, engine);
    l.weights = dnnl::memory(forward.weights_desc(), engine);
    l.bias = dnnl::memory(geometry.bias, engine);
    l.forward = dnnl::convolution_forward(forward);
    if (use == Use::kTraining) AddBackward(layer, geometry, l);
  }

  void AddBackward(int layer, const Geometry& g, Layer& l) {
    const auto hint = ForwardOf(g, false, engine);
    const dnnl::convolution_backward_weights::primitive_desc to_weights(
        {kAlgorithm, g.source, g.weights, g.bias, g.destination, g.strides, g.padding,
         g.end_padding},
        engine, hint);
    l.destination_gradient = dnnl::memory(g.destination, engine);
    l.weight_gradient = dnnl::memory(to_weights.diff_weights_desc(), engine);
    l.bias_gradient = dnnl::memory(g.bias, engine);
    l.plain_gradient = dnnl::memory(PlainWeights(layer), engine);
    l.to_weights = dnnl::convolution_backward_weights(to_weights);
    if (layer == 0) return;
    const dnnl::convolution_backward_data::primitive_desc to_source(
        {kAlgorithm, g.source, g.weights, g.destination, g.strides, g.padding, g.end_padding},
        engine, hint);
    l.source_gradient = dnnl::memory(g.source, engine);
    l.back_weights = dnnl::memory(to_source.weights_desc(), engine);
    l.to_source = dnnl::convolution_backward_data(to_source);
  }

  /// The order of NetworkWeights.
  dnnl::memory::desc PlainWeights(int layer) const {
    return Floats({shape.OutputsOf(layer), shape.InputsOf(layer), 3, 3}, Tag::hwio);
  }

  void Reorder(dnnl::memory from, dnnl::memory to) {
    dnnl::reorder(from, to).execute(stream, from, to);
    stream.wait();
  }

  void Run(const dnnl::primitive& primitive, const Arguments& arguments) {
    primitive.execute(stream, arguments);
    stream.wait();
  }

  void BackwardLayer(std::size_t index, NetworkWeights& gradient) {
    const Layer& l = layers[index];
    Run(l.to_weights, {{DNNL_ARG_SRC, l.source},
                       {DNNL_ARG_DIFF_DST, l.destination_gradient},
                       {DNNL_ARG_DIFF_WEIGHTS, l.weight_gradient},
                       {DNNL_ARG_DIFF_BIAS, l.bias_gradient}});
    Reorder(l.weight_gradient, l.plain_gradient);
    const auto add = [](const dnnl::memory& from, std::vector<float>& to) {
      const auto values = Values(from);
      for (std::size_t i = 0; i < to.size(); ++i) to[i] += values[i];
    };
    add(l.plain_gradient, gradient.weights[index]);
    add(l.bias_gradient, gradient.biases[index]);
    if (index == 0) return;
    Run(*l.to_source, {{DNNL_ARG_DIFF_DST, l.destination_gradient},
                       {DNNL_ARG_WEIGHTS, l.back_weights},
                       {DNNL_ARG_DIFF_SRC, l.source_gradient}});
    const Layer& before = layers[index - 1];
    const auto from = Values(l.source_gradient);
    const auto to = Values(before.destination_gradient);
    if (Upsamples(static_cast<int>(index))) {
      SumUpsampled(before.out, l.in, l.inputs, from.data(), to.data());
    } else {
      std::ranges::copy(from, to.begin());
    }
    MaskGradient(Values(before.destination), to);
  }

  NetworkShape shape;
  Use use;
  dnnl::engine engine;
  dnnl::stream stream;
  std::vector<Layer> layers;
  std::shared_ptr<const NetworkWeights> weights;
};

EncoderDecoderPass::EncoderDecoderPass(NetworkShape shape, int rows, int columns, Use use)
    : rows_(rows), columns_(columns) {
  DEMAND(shape.architecture == Architecture::kEncoderDecoder && rows > 0 && columns > 0,
         shape.width, rows, columns);
  network_ = std::make_unique<Network>(shape, rows, columns, use);
}

EncoderDecoderPass::~EncoderDecoderPass() = default;

void EncoderDecoderPass::SetWeights(const std::shared_ptr<const NetworkWeights>& weights) {
  Network& n = *network_;
  if (n.weights == weights) return;
  DEMAND(weights->shape == n.shape, weights->shape.width, n.shape.width);
  const OnThisThread guard;
  n.weights = weights;
  for (std::size_t i = 0; i < n.layers.size(); ++i) {
    const Network::Layer& l = n.layers[i];
    dnnl::memory plain(n.PlainWeights(static_cast<int>(i)), n.engine,
                       const_cast<float*>(weights->weights[i].data()));
    n.Reorder(plain, l.weights);
    if (l.to_source) n.Reorder(plain, l.back_weights);
    std::ranges::copy(weights->biases[i], Values(l.bias).begin());
  }
}

std::span<const float> EncoderDecoderPass::Forward(std::span<const float> input) {
  Network& n = *network_;
  const auto first = Values(n.layers.front().source);
  DEMAND(n.weights != nullptr && input.size() == first.size(), input.size(), first.size());
  const OnThisThread guard;
  std::ranges::copy(input, first.begin());
  for (std::size_t i = 0; i < n.layers.size(); ++i) {
    const Network::Layer& l = n.layers[i];
    if (Upsamples(static_cast<int>(i))) {
      const Network::Layer& before = n.layers[i - 1];
      Upsample(before.out, l.in, l.inputs, Values(before.destination).data(),
               Values(l.source).data());
    }
    n.Run(l.forward, {{DNNL_ARG_SRC, l.source},
                      {DNNL_ARG_WEIGHTS, l.weights},
                      {DNNL_ARG_BIAS, l.bias},
                      {DNNL_ARG_DST, l.destination}});
  }
  return Values(n.layers.back().destination);
}

void EncoderDecoderPass::Backward(std::span<const float> logit_gradient, NetworkWeights& gradient) {
  Network& n = *network_;
  DEMAND(n.use == Use::kTraining && gradient.shape == n.shape);
  const auto last = Values(n.layers.back().destination_gradient);
  DEMAND(logit_gradient.size() == last.size(), logit_gradient.size(), last.size());
  const OnThisThread guard;
  std::ranges::copy(logit_gradient, last.begin());
  for (std::size_t i = n.layers.size(); i-- > 0;) n.BackwardLayer(i, gradient);
}

}  // namespace conav::nhpm
