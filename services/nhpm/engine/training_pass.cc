#include "nhpm/engine/training_pass.h"

#include <algorithm>
#include <array>
#include <vector>

#include "common/runtime/result.h"
#include "nhpm/engine/inference_pass.h"
#include "nhpm/engine/kernels.h"

namespace conav::nhpm {
namespace {

/// `sums` is scratch memory of the size of `gradient`.
void AddBiasGradient(const CellList& list, const AlignedFloats& out_gradient, std::span<float> sums,
                     std::vector<float>& gradient) {
  std::fill(sums.begin(), sums.end(), 0.0F);
  for (const std::int32_t cell : list.cells) {
    const float* from = out_gradient.data() + cell * std::ssize(sums);
    for (std::size_t o = 0; o < sums.size(); ++o) sums[o] += from[o];
  }
  for (std::size_t o = 0; o < sums.size(); ++o) gradient[o] += sums[o];
}

/// Turns the gradient after a ReLU into the one before it. Border cells are zero and stay so.
void MaskByRelu(const AlignedFloats& activation, AlignedFloats& gradient) {
  for (std::size_t i = 0; i < gradient.size(); ++i) {
    gradient[i] = activation[i] > 0.0F ? gradient[i] : 0.0F;
  }
}

}  // namespace

struct TrainingPass::Workspace {
  Workspace(NetworkShape shape, int rows, int columns)
      : shape(shape),
        kernels(KernelsFor(shape.width)),
        grid(rows, columns),
        zero_bias(static_cast<std::size_t>(shape.width), 0.0F),
        bias_sums(static_cast<std::size_t>(shape.width)),
        logits(grid.size() * kOutputChannels) {
    for (int layer = 0; layer < kNetworkLayers; ++layer) {
      const auto i = static_cast<std::size_t>(layer);
      inputs[i] = grid.Activations(shape.InputsOf(layer));
      gradients[i] = grid.Activations(shape.OutputsOf(layer));
    }
    padded_logits = grid.Activations(kOutputChannels);
  }

  NetworkShape shape;
  const KernelSet& kernels;
  PaddedGrid grid;
  std::vector<float> zero_bias;
  std::vector<float> bias_sums;
  std::array<AlignedFloats, kNetworkLayers> inputs;     // of each layer, padded
  std::array<AlignedFloats, kNetworkLayers> gradients;  // of each layer's output, padded
  AlignedFloats padded_logits;
  std::vector<float> logits;
};

TrainingPass::TrainingPass(NetworkShape shape, int rows, int columns) {
  if (shape.architecture == Architecture::kEncoderDecoder) {
    encoder_decoder_ = std::make_unique<EncoderDecoderPass>(shape, rows, columns,
                                                            EncoderDecoderPass::Use::kTraining);
  } else {
    workspace_ = std::make_unique<Workspace>(shape, rows, columns);
  }
}
TrainingPass::~TrainingPass() = default;

std::span<const float> TrainingPass::Forward(const TrainingWeights& weights,
                                             std::span<const float> input) {
  if (encoder_decoder_) {
    encoder_decoder_->SetWeights(weights.plain_);
    return encoder_decoder_->Forward(input);
  }
  Workspace& w = *workspace_;
  const PackedWeights& packed = weights.packed_.value();
  DEMAND(packed.shape == w.shape && input.size() == w.grid.size() * kInputChannels, input.size());
  const CellList cells = w.grid.AllCells();
  w.grid.Pad(kInputChannels, input, w.inputs[0]);
  const auto run = [&](ConvolutionKernel kernel, std::size_t layer, AlignedFloats& out) {
    kernel(w.inputs[layer].data(), cells, packed.forward[layer].data(), packed.biases[layer].data(),
           out.data());
  };
  run(w.kernels.first, 0, w.inputs[1]);
  run(w.kernels.hidden, 1, w.inputs[2]);
  run(w.kernels.hidden, 2, w.inputs[3]);
  run(w.kernels.last, 3, w.padded_logits);
  w.grid.Unpad(kOutputChannels, w.padded_logits, w.logits);
  return w.logits;
}

void TrainingPass::Backward(const TrainingWeights& weights, std::span<const float> logit_gradient,
                            NetworkWeights& gradient) {
  if (encoder_decoder_) return encoder_decoder_->Backward(logit_gradient, gradient);
  Workspace& w = *workspace_;
  const PackedWeights& packed = weights.packed_.value();
  DEMAND(gradient.shape == w.shape && logit_gradient.size() == w.logits.size());
  const CellList cells = w.grid.AllCells();
  w.grid.Pad(kOutputChannels, logit_gradient, w.gradients[3]);
  for (std::size_t layer = kNetworkLayers; layer-- > 0;) {
    const auto kernel = layer == 0   ? w.kernels.first_gradient
                        : layer == 3 ? w.kernels.last_gradient
                                     : w.kernels.hidden_gradient;
    kernel(w.inputs[layer].data(), w.gradients[layer].data(), cells,
           gradient.weights[layer].data());
    std::vector<float>& biases = gradient.biases[layer];
    AddBiasGradient(cells, w.gradients[layer], std::span(w.bias_sums).first(biases.size()), biases);
    if (layer == 0) return;
    const auto back = layer == 3 ? w.kernels.last_backward : w.kernels.hidden_backward;
    back(w.gradients[layer].data(), cells, packed.backward[layer].data(), w.zero_bias.data(),
         w.gradients[layer - 1].data());
    MaskByRelu(w.inputs[layer], w.gradients[layer - 1]);
  }
}

}  // namespace conav::nhpm
