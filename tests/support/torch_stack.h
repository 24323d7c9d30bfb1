#pragma once

#include <torch/torch.h>

#include "nhpm/training/example.h"

namespace conav::test {

/// [examples][channels][rows][columns] of values that are kept as [rows][columns][channels]:
/// value(example, index).
template <class Value>
torch::Tensor Stack(const nhpm::ExampleSet& set, int channels, Value value) {
  const auto count = static_cast<std::int64_t>(set.examples.size());
  torch::Tensor stacked = torch::zeros({count, set.rows, set.columns, channels});
  float* to = stacked.data_ptr<float>();
  const auto size = static_cast<std::size_t>(set.rows * set.columns * channels);
  for (const nhpm::Example& example : set.examples) {
    for (std::size_t i = 0; i < size; ++i) *to++ = value(example, i);
  }
  return stacked.permute({0, 3, 1, 2}).contiguous();
}

}  // namespace conav::test
