#pragma once

#include <memory>
#include <span>

#include "nhpm/engine/kernels.h"
#include "nhpm/engine/network_weights.h"

namespace conav::bench {

/// The same network on oneDNN: one thread, its own choice of algorithm and memory layout, ReLU
/// fused, sigmoid at the end. The peer of `conav bench nhpm`.
class OneDnnNetwork {
 public:
  /// `set` bounds the instructions that oneDNN may use, for the rest of the process.
  OneDnnNetwork(const nhpm::NetworkWeights& weights, int rows, int columns,
                nhpm::InstructionSet set);
  ~OneDnnNetwork();

  /// Input [rows][columns][kInputChannels]; returns probabilities [rows][columns][kOutputChannels],
  /// not masked, valid until the next call.
  std::span<const float> Run(std::span<const float> input);

  static const char* version();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace conav::bench
