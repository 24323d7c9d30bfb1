#include "nhpm/engine/inference_pass.h"

#include <cstring>

#include "common/runtime/result.h"

namespace conav::nhpm {

InferencePass::InferencePass(std::shared_ptr<const PackedWeights> weights, const KernelSet& kernels,
                             int rows, int columns)
    : weights_(std::move(weights)),
      kernels_(kernels),
      grid_(rows, columns),
      input_(grid_.Activations(kInputChannels)),
      base_input_(grid_.size() * kInputChannels),
      inside_(grid_.padded_size(), 0),
      mask_(grid_.padded_size(), 0),
      grown_(grid_.padded_size(), 0),
      logits_(grid_.size() * kOutputChannels) {
  DEMAND(kernels_.width == weights_->shape.width, kernels_.width, weights_->shape.width);
  for (int layer = 0; layer < kNetworkLayers; ++layer) {
    Layer& target = layers_[static_cast<std::size_t>(layer)];
    target.channels = weights_->shape.OutputsOf(layer);
    target.current = grid_.Activations(target.channels);
    target.dirty.reserve(grid_.size());
  }
  for (const std::int32_t cell : grid_.AllCells().cells) {
    inside_[static_cast<std::size_t>(cell)] = 1;
  }
  list_.reserve(grid_.size());
}

std::size_t InferencePass::bytes() const {
  std::size_t floats = input_.size() + base_input_.size() + logits_.size();
  for (const Layer& layer : layers_) floats += layer.base.size() + layer.current.size();
  return floats * sizeof(float);
}

void InferencePass::Compute(std::size_t layer, const CellList& cells) {
  const auto kernel = layer == 0                    ? kernels_.first
                      : layer == kNetworkLayers - 1 ? kernels_.last
                                                    : kernels_.hidden;
  const AlignedFloats& in = layer == 0 ? input_ : layers_[layer - 1].current;
  kernel(in.data(), cells, weights_->forward[layer].data(), weights_->biases[layer].data(),
         layers_[layer].current.data());
}

std::span<const float> InferencePass::Full(std::span<const float> input) {
  DEMAND(input.size() == base_input_.size(), input.size(), base_input_.size());
  grid_.Pad(kInputChannels, input, input_);
  for (std::size_t layer = 0; layer < kNetworkLayers; ++layer) {
    Compute(layer, grid_.AllCells());
    const auto all = grid_.AllCells().cells;
    layers_[layer].dirty.assign(all.begin(), all.end());
  }
  return Logits();
}

void InferencePass::SetBase(std::span<const float> input) {
  Full(input);
  base_input_.assign(input.begin(), input.end());
  for (Layer& layer : layers_) {
    layer.base = layer.current;
    layer.dirty.clear();
  }
  has_base_ = true;
}

std::span<const float> InferencePass::FromBase(std::span<const float> input) {
  DEMAND(has_base_ && input.size() == base_input_.size(), input.size(), base_input_.size());
  grid_.Pad(kInputChannels, input, input_);
  MarkDifferences(input);
  for (std::size_t layer = 0; layer < kNetworkLayers; ++layer) {
    Grow();
    ListMask();
    Restore(layers_[layer]);
    Compute(layer, {list_, grid_.stride()});
    layers_[layer].dirty.assign(list_.begin(), list_.end());
  }
  return Logits();
}

void InferencePass::MarkDifferences(std::span<const float> input) {
  std::size_t i = 0;
  for (const std::int32_t cell : grid_.AllCells().cells) {
    constexpr std::size_t kBytes = kInputChannels * sizeof(float);
    const bool differs = std::memcmp(&input[i], &base_input_[i], kBytes) != 0;
    mask_[static_cast<std::size_t>(cell)] = differs ? 1 : 0;
    i += kInputChannels;
  }
}

/// Grows the mask by one cell in all eight directions.
void InferencePass::Grow() {
  const auto stride = static_cast<std::size_t>(grid_.stride());
  const std::size_t end = mask_.size() - stride;
  const std::uint8_t* mask = mask_.data();
  std::uint8_t* grown = grown_.data();
  for (std::size_t i = 1; i + 1 < mask_.size(); ++i) {
    grown[i] = static_cast<std::uint8_t>(mask[i - 1] | mask[i] | mask[i + 1]);
  }
  for (std::size_t i = stride; i < end; ++i) {
    mask_[i] =
        static_cast<std::uint8_t>((grown[i - stride] | grown[i] | grown[i + stride]) & inside_[i]);
  }
}

void InferencePass::ListMask() {
  list_.resize(grid_.size());
  std::size_t count = 0;
  for (const std::int32_t cell : grid_.AllCells().cells) {
    list_[count] = cell;
    count += mask_[static_cast<std::size_t>(cell)];
  }
  list_.resize(count);
}

/// Restores the cells that differ from the base and that this call will not compute.
void InferencePass::Restore(Layer& layer) const {
  for (const std::int32_t cell : layer.dirty) {
    if (mask_[static_cast<std::size_t>(cell)] != 0) continue;
    const std::ptrdiff_t at = std::ptrdiff_t{cell} * layer.channels;
    std::copy_n(layer.base.begin() + at, layer.channels, layer.current.begin() + at);
  }
}

std::span<const float> InferencePass::Logits() {
  grid_.Unpad(kOutputChannels, layers_.back().current, logits_);
  return logits_;
}

}  // namespace conav::nhpm
