#include "nhpm/training/checkpoint.h"

#include <catch2/catch.hpp>
#include <cmath>

#include "support/temporary_folder.h"

namespace conav::nhpm {
namespace {

Checkpoint SomeCheckpoint() {
  Checkpoint checkpoint;
  checkpoint.settings = {{"seed", "3"}, {"width", "16"}};
  checkpoint.state.weights = InitialWeights({16}, 1);
  checkpoint.state.adam = {InitialWeights({16}, 2), InitialWeights({16}, 3), 77};
  checkpoint.state.best = InitialWeights({16}, 4);
  checkpoint.state.best_epoch = 1;
  checkpoint.state.epochs = {{1, 0.25, 0.5}, {2, 0.125, 0.1 + 0.2}};
  return checkpoint;
}

TEST_CASE("A checkpoint is read as it was written", "[training]") {
  const test::TemporaryFolder folder;
  REQUIRE(WriteCheckpoint(folder / "checkpoint", SomeCheckpoint()));
  CHECK((ReadCheckpoint(folder / "checkpoint").value() == SomeCheckpoint()));
}

TEST_CASE("A checkpoint that contradicts itself is refused", "[training]") {
  const std::pair<const char*, void (*)(TrainingState&)> rows[] = {
      {"best epoch 3", [](TrainingState& state) { state.best_epoch = 3; }},
      {"second moments", [](TrainingState& s) { s.adam.second = InitialWeights({32}, 3); }},
      {"losses of epoch 2", [](TrainingState& state) { state.epochs[1].train_loss = NAN; }},
  };
  for (const auto& [names, spoil] : rows) {
    Checkpoint checkpoint = SomeCheckpoint();
    spoil(checkpoint.state);
    const test::TemporaryFolder folder;
    REQUIRE(WriteCheckpoint(folder / "checkpoint", checkpoint));
    const auto read = ReadCheckpoint(folder / "checkpoint");
    REQUIRE_FALSE(read);
    CHECK(read.error().code == ErrorCode::kMalformed);
    CHECK_THAT(read.error().text, Catch::Contains("checkpoint: ") && Catch::Contains(names));
  }
}

TEST_CASE("Differences between settings are named", "[training]") {
  CHECK(DifferenceText({{"seed", "1"}}, {{"seed", "1"}}).empty());
  CHECK(DifferenceText({{"data", "x"}, {"seed", "1"}}, {{"data", "x"}, {"seed", "2"}}) ==
        "seed 1 there, 2 now");
  CHECK(DifferenceText({{"a", "1"}}, {{"b", "2"}}) ==
        "a 1 there, (nothing) now; b (nothing) there, 2 now");
}

}  // namespace
}  // namespace conav::nhpm
