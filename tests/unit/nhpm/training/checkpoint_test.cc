#include "nhpm/training/checkpoint.h"

#include <catch2/catch.hpp>
#include <cmath>

#include "common/runtime/file.h"
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
  const std::filesystem::path file = folder / "checkpoint";
  const Checkpoint checkpoint = SomeCheckpoint();
  REQUIRE(WriteCheckpoint(file, checkpoint));
  const auto read = ReadCheckpoint(file);
  REQUIRE(read);
  CHECK((*read == checkpoint));
}

TEST_CASE("A checkpoint that is cut off, damaged or something else is refused", "[training]") {
  const test::TemporaryFolder folder;
  const std::filesystem::path file = folder / "checkpoint";
  REQUIRE(WriteCheckpoint(file, SomeCheckpoint()));
  std::string bytes = ReadFile(file).value();
  const auto refused = [&](std::string_view changed) {
    REQUIRE(WriteFile(file, changed));
    const auto read = ReadCheckpoint(file);
    return !read && read.error().code == ErrorCode::kMalformed;
  };
  for (const std::size_t size : {0UL, 3UL, 79UL, 80UL, 81UL, bytes.size() / 2, bytes.size() - 1}) {
    CHECK(refused(std::string_view(bytes).substr(0, size)));
  }
  CHECK(refused("CNVW" + bytes.substr(4)));
  bytes[bytes.size() - 9] = static_cast<char>(bytes[bytes.size() - 9] ^ 1);
  CHECK(refused(bytes));
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
