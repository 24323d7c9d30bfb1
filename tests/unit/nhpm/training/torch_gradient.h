#pragma once

#include "nhpm/engine/network_weights.h"
#include "nhpm/training/example.h"

namespace conav::nhpm {

struct TorchResult {
  double loss = 0.0;  // mean of the examples
  NetworkWeights gradient;
};

/// Loss and gradient of the mean over all examples by libtorch's automatic differentiation.
TorchResult TorchGradient(const NetworkWeights& weights, const ExampleSet& set);

}  // namespace conav::nhpm
