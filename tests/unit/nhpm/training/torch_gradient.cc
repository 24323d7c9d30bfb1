// Apart from the test: torch's headers bring a CHECK of their own.
#include "unit/nhpm/training/torch_gradient.h"

#include "support/torch_stack.h"

namespace conav::nhpm {
namespace {

using test::Stack;

/// A parameter with gradient of a copy of `values`.
torch::Tensor Parameter(const std::vector<float>& values, torch::IntArrayRef shape) {
  torch::Tensor tensor = torch::tensor(values).reshape(shape).clone();
  return tensor.set_requires_grad(true);
}

void CopyGradient(const torch::Tensor& parameter, std::vector<float>& to) {
  const torch::Tensor gradient = parameter.grad().contiguous();
  to.assign(gradient.data_ptr<float>(), gradient.data_ptr<float>() + gradient.numel());
}

}  // namespace

TorchResult TorchGradient(const NetworkWeights& weights, const ExampleSet& set) {
  const auto label = [](OutputLabel wanted) {
    return [wanted](const Example& example, std::size_t i) {
      return example.labels[i] == wanted ? 1.0F : 0.0F;
    };
  };
  std::vector<torch::Tensor> kernels;  // [ky][kx][inputs][outputs]
  std::vector<torch::Tensor> biases;
  torch::Tensor value = Stack(
      set, kInputChannels, [](const Example& example, std::size_t i) { return example.input[i]; });
  for (int layer = 0; layer < kNetworkLayers; ++layer) {
    const auto i = static_cast<std::size_t>(layer);
    const int inputs = weights.shape.InputsOf(layer);
    const int outputs = weights.shape.OutputsOf(layer);
    kernels.push_back(Parameter(weights.weights[i], {3, 3, inputs, outputs}));
    biases.push_back(Parameter(weights.biases[i], {outputs}));
    value = torch::conv2d(value, kernels.back().permute({3, 2, 0, 1}), biases.back(), 1, 1);
    if (layer + 1 < kNetworkLayers) value = torch::relu(value);
  }
  const torch::Tensor unmasked = 1.0 - Stack(set, kOutputChannels, label(OutputLabel::kMasked));
  const torch::Tensor loss = torch::binary_cross_entropy_with_logits(
      value, Stack(set, kOutputChannels, label(OutputLabel::kEdited)), unmasked);
  loss.backward();
  TorchResult result{loss.item<double>(), ZeroWeights(weights.shape)};
  for (std::size_t i = 0; i < kNetworkLayers; ++i) {
    CopyGradient(kernels[i], result.gradient.weights[i]);
    CopyGradient(biases[i], result.gradient.biases[i]);
  }
  return result;
}

}  // namespace conav::nhpm
