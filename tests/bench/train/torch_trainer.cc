#include "bench/train/torch_trainer.h"

#include "support/torch_stack.h"

namespace conav::bench {
namespace {

using nhpm::kInputChannels;
using nhpm::kOutputChannels;
using test::Stack;

torch::nn::Conv2d Convolution(int inputs, int outputs) {
  return torch::nn::Conv2d(torch::nn::Conv2dOptions(inputs, outputs, 3).padding(1));
}

}  // namespace

struct TorchTrainer::State {
  State(int width, int batch, const nhpm::ExampleSet& set)
      : batch(batch),
        network(Convolution(kInputChannels, width), torch::nn::ReLU(), Convolution(width, width),
                torch::nn::ReLU(), Convolution(width, width), torch::nn::ReLU(),
                Convolution(width, kOutputChannels)),
        optimizer(network->parameters(), torch::optim::AdamOptions(1e-3)),
        inputs(Stack(set, kInputChannels,
                     [](const nhpm::Example& example, std::size_t i) { return example.input[i]; })),
        labels(Stack(set, kOutputChannels,
                     [](const nhpm::Example& example, std::size_t i) {
                       return example.labels[i] == nhpm::OutputLabel::kEdited ? 1.0F : 0.0F;
                     })),
        unmasked(Stack(set, kOutputChannels, [](const nhpm::Example& example, std::size_t i) {
          return example.labels[i] == nhpm::OutputLabel::kMasked ? 0.0F : 1.0F;
        })) {}

  int batch;
  torch::nn::Sequential network;
  torch::optim::Adam optimizer;
  torch::Tensor inputs;
  torch::Tensor labels;
  torch::Tensor unmasked;
};

TorchTrainer::TorchTrainer(int width, int batch, int threads, const nhpm::ExampleSet& set) {
  torch::set_num_threads(threads);
  torch::manual_seed(1);
  state_ = std::make_unique<State>(width, batch, set);
}
TorchTrainer::~TorchTrainer() = default;

void TorchTrainer::RunEpoch() {
  State& s = *state_;
  const std::int64_t count = s.inputs.size(0);
  const torch::Tensor order = torch::randperm(count);
  for (std::int64_t first = 0; first < count; first += s.batch) {
    const torch::Tensor chosen =
        order.slice(0, first, std::min<std::int64_t>(first + s.batch, count));
    s.optimizer.zero_grad();
    const torch::Tensor logits = s.network->forward(s.inputs.index_select(0, chosen));
    const torch::Tensor loss = torch::binary_cross_entropy_with_logits(
        logits, s.labels.index_select(0, chosen), s.unmasked.index_select(0, chosen));
    loss.backward();
    s.optimizer.step();
  }
}

}  // namespace conav::bench
