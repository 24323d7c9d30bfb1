#include "nhpm/training/example.h"

#include <catch2/catch.hpp>

namespace conav::nhpm {
namespace {

using enum OutputLabel;

/// 3 x 4: two cells inside, a wall in the second; the person adds one and removes the other.
Segment OneEditSegment() {
  Segment segment;
  segment.query.belief = BeliefGrid(3, 4, 1.0F);
  segment.query.belief[{1, 1}] = 0.0F;
  segment.query.path = {{1, 1}};
  segment.query.cell = {1, 1};
  segment.query.visible = {{{1, 1}, {1, 2}}, {}};
  segment.belief_after = segment.query.belief;
  segment.belief_after[{1, 1}] = 1.0F;
  segment.belief_after[{1, 2}] = 0.0F;
  return segment;
}

SegmentSet SetOf(std::vector<Segment> segments) {
  Trajectory trajectory;
  trajectory.segments = std::move(segments);
  return {{trajectory}};
}

TEST_CASE("Only outputs that can be edits are learned from", "[training]") {
  const ExampleSet set = ExamplesOf(SetOf({OneEditSegment()}), {});
  CHECK(set.rows == 3);
  CHECK(set.columns == 4);
  REQUIRE(set.examples.size() == 1);
  const std::vector<OutputLabel>& labels = set.examples[0].labels;
  REQUIRE(labels.size() == 24);
  for (std::size_t i = 0; i < labels.size(); ++i) {
    const bool edited = i == 10 || i == 13;  // add at (1, 1), remove at (1, 2)
    CHECK(labels[i] == (edited ? kEdited : kMasked));
  }
  Segment untouched = OneEditSegment();
  untouched.belief_after = untouched.query.belief;
  const ExampleSet kept = ExamplesOf(SetOf({untouched}), {});
  CHECK(kept.examples[0].labels[10] == kKept);
  CHECK(kept.examples[0].labels[13] == kKept);
  CHECK(ExamplesOf({}, {}).examples.empty());
}

TEST_CASE("The input is the encoded query, an input left out leaves the masks as they are",
          "[training]") {
  const Segment segment = OneEditSegment();
  const InputSelection inputs{.belief = false, .path = false, .view = true};
  const ExampleSet set = ExamplesOf(SetOf({segment}), inputs);
  std::vector<float> expected(12 * kInputChannels);
  EncodeInput(segment.query, inputs, expected);
  CHECK((set.examples[0].input == expected));
  const ExampleSet with = ExamplesOf(SetOf({segment}), {});
  CHECK((with.examples[0].labels == set.examples[0].labels));
  CHECK_FALSE((with.examples[0].input == set.examples[0].input));
}

TEST_CASE("Maps of two sizes are refused", "[training]") {
  Segment other = OneEditSegment();
  other.query.belief = BeliefGrid(5, 4, 1.0F);
  other.belief_after = other.query.belief;
  CHECK(CheckOneSize(SetOf({OneEditSegment(), OneEditSegment()})));
  const auto checked = CheckOneSize(SetOf({OneEditSegment(), other}));
  REQUIRE_FALSE(checked);
  CHECK(checked.error().code == ErrorCode::kInvalidArgument);
  CHECK_THAT(checked.error().text, Catch::Contains("3 x 4") && Catch::Contains("5 x 4"));
}

TEST_CASE("The share of edits never is 0 or 1", "[training]") {
  CHECK(EditShare({}) == 0.5);
  CHECK(EditShare({1, 1, {{{}, {kKept, kMasked}}, {{}, {kKept, kEdited}}}}) == 2.0 / 5.0);
}

}  // namespace
}  // namespace conav::nhpm
