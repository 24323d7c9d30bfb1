#include "nhpm/engine/kernels.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <cstring>

#include "common/runtime/random.h"
#include "nhpm/engine/inference_pass.h"
#include "nhpm/engine/kernel_templates.h"
#include "nhpm/engine/packed_weights.h"

namespace conav::nhpm {
namespace {

using Floats = std::vector<float>;

float RandomFloat(Random& random) { return static_cast<float>(2.0 * random.Unit() - 1.0); }

/// Padded activations with random values inside and zeros on the border.
Floats RandomActivations(const PaddedGrid& grid, int channels, std::uint64_t seed) {
  Random random(seed);
  Floats values(grid.padded_size() * static_cast<std::size_t>(channels), 0.0F);
  for (const std::int32_t cell : grid.AllCells().cells) {
    for (int i = 0; i < channels; ++i) {
      values[static_cast<std::size_t>(cell * channels + i)] = RandomFloat(random);
    }
  }
  return values;
}

TEST_CASE("all instruction sets give the same bits", "[engine]") {
  const int width = GENERATE(16, 32, 64);
  const PaddedGrid grid(6, 5);
  NetworkWeights weights = InitialWeights({width}, 7);
  Random random(8);
  for (auto& biases : weights.biases) {
    for (float& bias : biases) bias = RandomFloat(random);
  }
  const PackedWeights packed(weights, PackedWeights::Use::kTraining);
  const Floats input = RandomActivations(grid, kInputChannels, 1);
  const Floats hidden = RandomActivations(grid, width, 2);
  const Floats logits = RandomActivations(grid, kOutputChannels, 3);
  const CellList cells = grid.AllCells();
  const auto results = [&](InstructionSet set) {
    const KernelSet& kernels = KernelsFor(width, set);
    constexpr std::size_t kEnough = 9 * 64 * 64;
    std::vector<Floats> out(8, Floats(kEnough, 0.0F));
    const auto convolve = [&](ConvolutionKernel kernel, const Floats& in,
                              const AlignedFloats& filter, std::size_t layer, Floats& target) {
      kernel(in.data(), cells, filter.data(), packed.biases[layer].data(), target.data());
    };
    convolve(kernels.first, input, packed.forward[0], 0, out[0]);
    convolve(kernels.hidden, hidden, packed.forward[1], 1, out[1]);
    convolve(kernels.last, hidden, packed.forward[3], 3, out[2]);
    convolve(kernels.last_backward, logits, packed.backward[3], 0, out[3]);
    convolve(kernels.hidden_backward, hidden, packed.backward[2], 0, out[4]);
    kernels.first_gradient(input.data(), hidden.data(), cells, out[5].data());
    kernels.hidden_gradient(hidden.data(), hidden.data(), cells, out[6].data());
    kernels.last_gradient(hidden.data(), logits.data(), cells, out[7].data());
    return out;
  };
  const auto expected = results(InstructionSet::kPortable);
  for (const InstructionSet set : AvailableInstructionSets()) {
    const auto actual = results(set);
    for (std::size_t i = 0; i < expected.size(); ++i) {
      CAPTURE(i);
      CHECK(std::memcmp(actual[i].data(), expected[i].data(), expected[i].size() * 4) == 0);
    }
  }
}

TEST_CASE("the emulated fused multiply-add rounds as the exact one", "[engine]") {
  Random random(5);
  const auto any_float = [&] {
    const double mantissa = 2.0 * random.Unit() - 1.0;
    return static_cast<float>(std::ldexp(mantissa, static_cast<int>(random.Uniform(-70, 60))));
  };
  int wrong = 0;
  for (int i = 0; i < 200000; ++i) {
    const float a = any_float();
    const float b = any_float();
    // Often near the product, where most is lost.
    const float c =
        random.Chance(0.5) ? any_float() : -a * b * (1.0F + 1e-6F * RandomFloat(random));
    wrong += EmulatedFma(a, b, c) == std::fma(a, b, c) ? 0 : 1;
  }
  CHECK(wrong == 0);
  // The product is halfway between two floats, and only the addend far below decides.
  const float halfway = 1.0F + 0x1p-12F;
  CHECK(EmulatedFma(halfway, halfway, 0x1p-60F) == std::fma(halfway, halfway, 0x1p-60F));
  CHECK(EmulatedFma(halfway, halfway, -0x1p-60F) == std::fma(halfway, halfway, -0x1p-60F));
  CHECK(EmulatedFma(2.0F, 3.0F, -6.0F) == 0.0F);
}

}  // namespace
}  // namespace conav::nhpm
