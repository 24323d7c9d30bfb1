#include "nhpm/engine/inference_pass.h"

#include <catch2/catch.hpp>

#include "common/runtime/random.h"
#include "nhpm/engine/training_pass.h"

namespace conav::nhpm {
namespace {

using Floats = std::vector<float>;

Floats Copy(std::span<const float> values) { return {values.begin(), values.end()}; }

Floats RandomInput(Random& random, int rows, int columns) {
  Floats input(static_cast<std::size_t>(rows * columns) * kInputChannels);
  for (float& value : input) value = random.Chance(0.3) ? 1.0F : 0.0F;
  return input;
}

std::shared_ptr<const PackedWeights> Packed(int width) {
  return std::make_shared<const PackedWeights>(InitialWeights({width}, 4, 0.0F),
                                               PackedWeights::Use::kInference);
}

/// Changes the base to `input`.
void Change(InferencePass& pass, const Floats& input) {
  for (std::size_t i = 0; i < input.size(); ++i) {
    const int cell = static_cast<int>(i) / kInputChannels;
    pass.Change(cell / pass.columns(), cell % pass.columns(), static_cast<int>(i) % kInputChannels,
                input[i]);
  }
}

TEST_CASE("from a base the logits have the bits of a full pass", "[engine]") {
  const auto [rows, columns] = GENERATE(table<int, int>({{13, 13}, {1, 1}, {3, 40}, {21, 17}}));
  const int width = GENERATE(16, 32, 64);
  CAPTURE(rows, columns, width);
  const auto weights = Packed(width);
  InferencePass pass(weights, KernelsFor(width), rows, columns);
  InferencePass whole(weights, KernelsFor(width), rows, columns);
  Random random(9);
  Floats base;
  for (const int changes : {0, 1, 3, 0, 10, 1, 200, 2}) {
    if (changes == 0) {  // a full pass and a new base in between leave nothing behind
      base = RandomInput(random, rows, columns);
      pass.SetBase(base);
      const Floats other = RandomInput(random, rows, columns);
      REQUIRE(Copy(pass.Full(other)) == Copy(whole.Full(other)));
    }
    Floats input = base;
    for (int i = 0; i < changes; ++i) {
      const auto at = random.Uniform(0, static_cast<std::int64_t>(input.size()) - 1);
      float& value = input[static_cast<std::size_t>(at)];
      value = 1.0F - value;
    }
    CAPTURE(changes);
    Change(pass, input);
    if (changes == 10) {  // these are part of the base from now on
      pass.MoveBase();
      base = input;
    } else {
      pass.FromBase();
    }
    REQUIRE(Copy(pass.Logits()) == Copy(whole.Full(input)));
  }
}

TEST_CASE("a pass from a base names the cells that it computed", "[engine]") {
  InferencePass pass(Packed(16), KernelsFor(16), 13, 20);
  Floats input(13 * 20 * kInputChannels, 0.0F);
  const Floats before = Copy(pass.SetBase(input));
  pass.Change(6, 9, 2, 1.0F);
  std::size_t differ = 0;
  const auto computed = pass.FromBase();
  CHECK(computed.size() == 9 * 9);
  for (const auto& cell : computed) {
    CHECK((std::abs(cell.row - 6) <= 4 && std::abs(cell.column - 9) <= 4));
    const auto at = static_cast<std::size_t>(cell.row * 20 + cell.column) * kOutputChannels;
    differ += cell.logits[0] != before[at] ? 1 : 0;
  }
  const Floats after = Copy(pass.Logits());
  std::size_t differ_in_all = 0;
  for (std::size_t i = 0; i < after.size(); i += kOutputChannels) {
    differ_in_all += after[i] != before[i] ? 1 : 0;
  }
  CHECK(differ == differ_in_all);
}

std::size_t cells_computed = 0;

template <ConvolutionKernel KernelSet::*kernel>
void Counted(const float* in, const CellList& cells, const float* weights, const float* bias,
             float* out) {
  cells_computed += cells.cells.size();
  (KernelsFor(16).*kernel)(in, cells, weights, bias, out);
}

TEST_CASE("only what a change can reach is computed in the hidden layers", "[engine]") {
  KernelSet kernels = KernelsFor(16);
  kernels.first = Counted<&KernelSet::first>;
  kernels.hidden = Counted<&KernelSet::hidden>;
  InferencePass pass(Packed(16), kernels, 13, 13);
  const auto computed = [&](const Floats& input) {
    Change(pass, input);
    cells_computed = 0;
    pass.FromBase();
    return cells_computed;
  };
  Floats input(13 * 13 * kInputChannels, 0.0F);
  pass.SetBase(input);
  CHECK(cells_computed == 3 * 13 * 13);
  CHECK(computed(input) == 0);
  input[(6 * 13 + 6) * kInputChannels] = 1.0F;
  CHECK(computed(input) == 3 * 3 + 5 * 5 + 7 * 7);
  input[(6 * 13 + 6) * kInputChannels] = 0.0F;
  input[0] = 1.0F;  // a corner
  CHECK(computed(input) == 2 * 2 + 3 * 3 + 4 * 4);
}

TEST_CASE("inference and training see the same logits", "[engine]") {
  const int width = GENERATE(16, 32, 64);
  const NetworkWeights weights = InitialWeights({width}, 4, 0.0F);
  InferencePass pass(Packed(width), KernelsFor(width), 13, 13);
  TrainingPass training({width}, 13, 13);
  const TrainingWeights training_weights(weights);
  Random random(11);
  const Floats input = RandomInput(random, 13, 13);
  CHECK(Copy(pass.Full(input)) == Copy(training.Forward(training_weights, input)));
}

}  // namespace
}  // namespace conav::nhpm
