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
      base_input_(input_),
      may_reach_(grid_.padded_size(), 0),
      logits_(grid_.size() * kOutputChannels) {
  DEMAND(kernels_.width == weights_->shape.width, kernels_.width, weights_->shape.width);
  for (int layer = 0; layer < kNetworkLayers; ++layer) {
    Layer& target = layers_[static_cast<std::size_t>(layer)];
    target.channels = weights_->shape.OutputsOf(layer);
    target.current = grid_.Activations(target.channels);
    target.dirty.reserve(grid_.size());
  }
  for (const std::int32_t cell : grid_.AllCells().cells) {
    may_reach_[static_cast<std::size_t>(cell)] = 1;
  }
  reached_.reserve(grid_.size());
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
  DEMAND(input.size() == grid_.size() * kInputChannels, input.size());
  grid_.Pad(kInputChannels, input, input_);
  const auto all = grid_.AllCells();
  for (std::size_t layer = 0; layer < kNetworkLayers; ++layer) {
    Compute(layer, all);
    layers_[layer].dirty.assign(all.cells.begin(), all.cells.end());
  }
  changes_.clear();
  if (has_base_) input_ = base_input_;
  return Logits();
}

std::span<const float> InferencePass::SetBase(std::span<const float> input) {
  has_base_ = false;
  const auto logits = Full(input);
  base_input_ = input_;
  for (Layer& layer : layers_) {
    layer.base = layer.current;
    layer.dirty.clear();
  }
  has_base_ = true;
  return logits;
}

void InferencePass::Change(int row, int column, int channel, float value) {
  const std::int32_t cell = grid_.IndexOf(row, column);
  input_[static_cast<std::size_t>(cell * kInputChannels + channel)] = value;
  changes_.push_back(cell);
}

std::span<const InferencePass::Computed> InferencePass::FromBase() {
  ComputeChanged();
  for (const std::int32_t cell : changes_) {
    std::copy_n(&base_input_[static_cast<std::size_t>(cell * kInputChannels)], kInputChannels,
                &input_[static_cast<std::size_t>(cell * kInputChannels)]);
  }
  changes_.clear();
  return ComputedCells();
}

std::span<const InferencePass::Computed> InferencePass::MoveBase() {
  ComputeChanged();
  for (const std::int32_t cell : changes_) {
    std::copy_n(&input_[static_cast<std::size_t>(cell * kInputChannels)], kInputChannels,
                &base_input_[static_cast<std::size_t>(cell * kInputChannels)]);
  }
  changes_.clear();
  for (Layer& layer : layers_) {
    for (const std::int32_t cell : layer.dirty) {
      const std::ptrdiff_t at = std::ptrdiff_t{cell} * layer.channels;
      std::copy_n(layer.current.begin() + at, layer.channels, layer.base.begin() + at);
    }
    layer.dirty.clear();
  }
  return ComputedCells();
}

void InferencePass::ComputeChanged() {
  DEMAND(has_base_);
  reached_.clear();
  for (const std::int32_t cell : changes_) {
    constexpr std::size_t kBytes = kInputChannels * sizeof(float);
    const auto at = static_cast<std::size_t>(cell * kInputChannels);
    if (std::memcmp(&input_[at], &base_input_[at], kBytes) != 0) Reach(cell);
  }
  std::size_t newest = 0;
  for (std::size_t layer = 0; layer < kNetworkLayers; ++layer) {
    const std::size_t before = reached_.size();
    ReachNeighbours(newest);
    newest = before;
    Restore(layers_[layer]);
    Compute(layer, {reached_, grid_.stride()});
    layers_[layer].dirty.assign(reached_.begin(), reached_.end());
  }
  for (const std::int32_t cell : reached_) may_reach_[static_cast<std::size_t>(cell)] = 1;
}

/// Reaches one cell further in all eight directions from those since `first`.
void InferencePass::ReachNeighbours(std::size_t first) {
  const std::int32_t stride = grid_.stride();
  const std::size_t last = reached_.size();
  for (std::size_t i = first; i < last; ++i) {
    for (const std::int32_t row : {-stride, 0, stride}) {
      for (const std::int32_t column : {-1, 0, 1}) Reach(reached_[i] + row + column);
    }
  }
}

/// Restores the cells that differ from the base and that this call will not compute.
void InferencePass::Restore(Layer& layer) const {
  for (const std::int32_t cell : layer.dirty) {
    if (may_reach_[static_cast<std::size_t>(cell)] == 0) continue;
    const std::ptrdiff_t at = std::ptrdiff_t{cell} * layer.channels;
    std::copy_n(layer.base.begin() + at, layer.channels, layer.current.begin() + at);
  }
}

std::span<const InferencePass::Computed> InferencePass::ComputedCells() {
  computed_.clear();
  const float* logits = layers_.back().current.data();
  for (const std::int32_t cell : reached_) {
    computed_.push_back({cell / grid_.stride() - 1, cell % grid_.stride() - 1,
                         logits + std::ptrdiff_t{cell} * kOutputChannels});
  }
  return computed_;
}

std::span<const float> InferencePass::Logits() {
  grid_.Unpad(kOutputChannels, layers_.back().current, logits_);
  return logits_;
}

}  // namespace conav::nhpm
