#include "nhpm/training/augmentation.h"

#include <algorithm>
#include <catch2/catch.hpp>

#include "conformance/perception_model_conformance.h"
#include "nhpm/training/trainer.h"

namespace conav::nhpm {
namespace {

/// A segment, edited where the picture shows that the map is wrong.
Segment MadeUpSegment(std::uint64_t seed, int rows, int columns) {
  Segment segment;
  segment.query = planner::conformance::MakeQuery(seed, rows, columns);
  segment.belief_after = segment.query.belief;
  BeliefGrid& after = segment.belief_after;
  for (const Cell cell : segment.query.visible.free) after[cell] = 0.0F;
  for (const Cell cell : segment.query.visible.walls) after[cell] = 1.0F;
  for (std::size_t i = 0; i < after.size(); ++i) {
    if (after.OnBorder(after.CellAt(i))) after.values()[i] = segment.query.belief.values()[i];
  }
  return segment;
}

ExampleSet MadeUpSet(int count, std::uint64_t seed, int rows = 9, int columns = 11) {
  SegmentSet set;
  Trajectory& trajectory = set.trajectories.emplace_back();
  for (int i = 0; i < count; ++i) {
    trajectory.segments.push_back(
        MadeUpSegment(DeriveSeed(seed, static_cast<std::uint64_t>(i)), rows, columns));
  }
  return ExamplesOf(set, {});
}

constexpr int kSmallCanvas = 40;

TEST_CASE("A pasted example is the encoding of the pasted query", "[training]") {
  const ExampleSet set = MadeUpSet(1, 5);
  const PerceptionQuery query = planner::conformance::MakeQuery(DeriveSeed(5, 0));
  const CanvasAugmentation augmentation(kPaperCanvas, set.rows, set.columns);
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    CAPTURE(seed);
    Example pasted;
    augmentation.Apply(seed, set.examples[0], pasted);
    Random random(seed);
    const CanvasMap map(DrawPlacement(kPaperCanvas, set.rows, set.columns, query.cell, random),
                        set.rows, set.columns);
    std::vector<float> expected(pasted.input.size());
    EncodeInput(map.Paste(query), {}, expected, kRasterDepthRange);
    CHECK(pasted.input == expected);
  }
}

TEST_CASE("Outputs outside of the map, on its border and on the canvas's are masked",
          "[training]") {
  const ExampleSet set = MadeUpSet(1, 6);
  const CanvasAugmentation augmentation(kSmallCanvas, set.rows, set.columns);
  const Grid<std::uint8_t> maze(set.rows, set.columns);
  const Grid<std::uint8_t> canvas(kSmallCanvas, kSmallCanvas);
  Example pasted;
  augmentation.Apply(9, set.examples[0], pasted);
  Random random(9);
  const CanvasMap map(
      DrawPlacement(kSmallCanvas, set.rows, set.columns, set.examples[0].camera, random), set.rows,
      set.columns);
  std::size_t open = 0;
  for (std::size_t i = 0; i < canvas.size(); ++i) {
    const std::int32_t source = map.sources()[i];
    const bool fixed = source < 0 || canvas.OnBorder(canvas.CellAt(i)) ||
                       maze.OnBorder(maze.CellAt(static_cast<std::size_t>(source)));
    const bool add = pasted.labels[2 * i] != OutputLabel::kMasked;
    const bool remove = pasted.labels[2 * i + 1] != OutputLabel::kMasked;
    CHECK((add != remove) != fixed);  // one of them can be, where the map can be edited
    open += fixed ? 0 : 1;
  }
  CHECK(open > 200);
}

TEST_CASE("Edits grow with the square of the scale", "[training]") {
  const ExampleSet set = MadeUpSet(1, 7);
  const CanvasAugmentation augmentation(kPaperCanvas, set.rows, set.columns);
  const auto edited = [](const Example& example) {
    return static_cast<double>(std::ranges::count(example.labels, OutputLabel::kEdited));
  };
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    Example pasted;
    augmentation.Apply(seed, set.examples[0], pasted);
    CAPTURE(seed);
    CHECK(edited(pasted) > 0.0);
    CHECK(edited(pasted) <= 1.1 * edited(set.examples[0]) * (150.0 / 11.0) * (150.0 / 11.0));
  }
}

TEST_CASE("Equal seeds give equal variants, others differ, and validation ones are fixed",
          "[training]") {
  const ExampleSet set = MadeUpSet(1, 8);
  const CanvasAugmentation augmentation(kSmallCanvas, set.rows, set.columns);
  Example first;
  Example again;
  Example other;
  augmentation.Apply(1, set.examples[0], first);
  augmentation.Apply(1, set.examples[0], again);
  augmentation.Apply(2, set.examples[0], other);
  CHECK((first == again));
  CHECK_FALSE((first.input == other.input));
  CHECK(augmentation.FixedVariant(3) == augmentation.FixedVariant(3));
  CHECK(augmentation.FixedVariant(3) != augmentation.FixedVariant(4));
}

TEST_CASE("A tiny encoder-decoder learns, with the same bits on any number of threads",
          "[training]") {
  const ExampleSet train = MadeUpSet(24, 1, 5, 5);
  const ExampleSet validation = MadeUpSet(8, 2, 5, 5);
  TrainingOptions options = EncoderDecoderOptions();
  options.width = 8;
  options.canvas = kSmallCanvas;
  options.epochs = 25;
  options.batch = 4;
  options.class_weight = 10.0;
  options.learning_rate = 3e-3;
  std::vector<TrainingState> states;
  for (const int threads : {1, 3}) {
    Trainer trainer(options, train, validation, threads,
                    InitialTrainingState(options, EditShare(train)));
    while (!trainer.finished()) REQUIRE(trainer.RunEpoch(StopToken{}));
    states.push_back(trainer.state());
  }
  CHECK((states[0] == states[1]));
  const auto& epochs = states[0].epochs;
  CHECK(epochs.back().train_loss < 0.9 * epochs.front().train_loss);
  CHECK(BestValidationLoss(states[0]) < epochs.front().validation_loss);
}

}  // namespace
}  // namespace conav::nhpm
