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

void ChangeCells(Random& random, int count, Floats& input) {
  for (int i = 0; i < count; ++i) {
    const auto at = random.Uniform(0, static_cast<std::int64_t>(input.size()) - 1);
    float& value = input[static_cast<std::size_t>(at)];
    value = 1.0F - value;
  }
}

std::shared_ptr<const PackedWeights> Packed(int width) {
  return std::make_shared<const PackedWeights>(InitialWeights({width}, 4, 0.0F),
                                               PackedWeights::Use::kInference);
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
    ChangeCells(random, changes, input);
    CAPTURE(changes);
    REQUIRE(Copy(pass.FromBase(input)) == Copy(whole.Full(input)));
  }
}

TEST_CASE("only what a change can reach is computed", "[engine]") {
  InferencePass pass(Packed(16), KernelsFor(16), 13, 13);
  Floats input(13 * 13 * kInputChannels, 0.0F);
  pass.SetBase(input);
  CHECK(pass.cells_computed() == pass.cells_of_full_pass());
  pass.FromBase(input);
  CHECK(pass.cells_computed() == 0);
  input[(6 * 13 + 6) * kInputChannels] = 1.0F;
  pass.FromBase(input);
  CHECK(pass.cells_computed() == 3 * 3 + 5 * 5 + 7 * 7);
  input[(6 * 13 + 6) * kInputChannels] = 0.0F;
  input[0] = 1.0F;  // a corner
  pass.FromBase(input);
  CHECK(pass.cells_computed() == 2 * 2 + 3 * 3 + 4 * 4);
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
