#pragma once

#include <memory>

#include "nhpm/training/example.h"

namespace conav::bench {

/// The same training with libtorch: network, loss, Adam, batches. The peer of `conav bench train`,
/// built where libtorch is installed.
class TorchTrainer {
 public:
  TorchTrainer(int width, int batch, int threads, const nhpm::ExampleSet& set);
  ~TorchTrainer();
  void RunEpoch();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace conav::bench
