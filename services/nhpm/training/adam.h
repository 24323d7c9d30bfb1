#pragma once

#include <cstdint>

#include "nhpm/engine/network_weights.h"

namespace conav::nhpm {

/// The defaults of D. P. Kingma and J. Ba, "Adam: A Method for Stochastic Optimization", ICLR 2015.
struct AdamOptions {
  float learning_rate = 1e-3F;
  float beta1 = 0.9F;
  float beta2 = 0.999F;
  float epsilon = 1e-8F;
};

struct AdamState {
  NetworkWeights first;   // moving mean of the gradient
  NetworkWeights second;  // ... of its square
  std::uint64_t steps = 0;
  bool operator==(const AdamState&) const = default;
};

AdamState InitialAdamState(NetworkShape shape);

/// One step down `gradient`; layers below `first_layer` stay as they are.
void AdamStep(const AdamOptions& options, const NetworkWeights& gradient, AdamState& state,
              NetworkWeights& weights, int first_layer = 0);

}  // namespace conav::nhpm
