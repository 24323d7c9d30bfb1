#include <catch2/catch.hpp>

#include "nhpm/evaluation/report.h"
#include "support/text.h"
#include "support/xml_check.h"
#include "unit/nhpm/evaluation/samples.h"

namespace conav::nhpm {
namespace {

TEST_CASE("The picture shows its cells, the path and where the camera looks", "[report_figure]") {
  Segment segment = EmptySegment();
  segment.query.path = {{1, 2}, {2, 2}};
  segment.query.visible = {{{2, 2}, {2, 3}}, {{2, 4}}};
  const std::string svg = ViewPanel(segment);
  CHECK(test::CountOf(svg, "class=\"seen-free\"") == 2);
  CHECK(test::CountOf(svg, "class=\"seen-wall\"") == 1);
  CHECK_THAT(svg, Catch::Contains("<polyline points=\"45.0,27.0 45.0,45.0\""));
  CHECK_THAT(svg, Catch::Contains("<polygon points=\"58.5,45.0 "));  // east of (2,2)
}

TEST_CASE("A prediction is as strong as its probability, small ones are left out",
          "[report_figure]") {
  const Segment segment = EmptySegment();
  PerceptionAnswer answer = ZeroAnswer(segment);
  answer.add[{1, 1}] = 0.375F;
  answer.add[{1, 2}] = 0.045F;
  answer.remove[{3, 3}] = 0.5F;
  const std::string svg = PredictionPanel(segment, answer, "A & B");
  CHECK_THAT(svg, Catch::Contains("class=\"add\" fill-opacity=\"0.375\""));
  CHECK_THAT(svg, Catch::Contains("class=\"remove\" fill-opacity=\"0.500\""));
  CHECK_THAT(svg, Catch::Contains(">38</text>"));
  CHECK(test::CountOf(svg, "fill-opacity") == 2);
  CHECK_THAT(svg, Catch::Contains("A &amp; B: 0.92 edits expected"));
  CHECK(test::XmlError(svg) == "");
}

TEST_CASE("The truth is signed, not only coloured", "[report_figure]") {
  Segment segment = EmptySegment();
  segment.query.belief[{1, 1}] = 1.0F;
  Flip(segment, {3, 3});
  const std::string svg = TruthPanel(segment);  // (1,1) is free afterwards: removed
  CHECK(test::CountOf(svg, ">+</text>") == 1);
  CHECK(test::CountOf(svg, ">\u2212</text>") == 1);
  CHECK_THAT(svg, Catch::Contains("Actual edits: 2"));
}

/// 11 x 11, the camera at (5,2) looks east.
Segment LooksEast(const std::vector<Cell>& walls) {
  Segment segment = EmptySegment(11, 11);
  segment.query.cell = {5, 2};
  segment.query.heading_rad = 0.0;
  segment.query.visible.walls = walls;
  return segment;
}

/// Walls that the picture shows, those that the person then changes, and what that is.
struct Edits {
  std::vector<Cell> shown;
  std::vector<Cell> flipped;
  bool misplaced_near;
  bool preferred_far;
};

TEST_CASE(
    "Near walls misplaced along the line of sight and far walls preferred to near ones at "
    "the side are found",
    "[figure_segments]") {
  for (const Edits& row : std::vector<Edits>{
           {{{5, 4}}, {}, false, false},
           {{{5, 4}}, {{5, 5}}, true, false},
           {{{5, 4}}, {{5, 5}, {5, 4}}, false, false},  // the wall itself was added, too
           {{{5, 4}}, {{5, 3}}, true, false},           // nearer
           {{{5, 4}}, {{4, 4}}, false, false},          // at its side
           {{{5, 7}}, {{5, 8}}, false, false},          // too far
           {{{4, 3}, {5, 7}}, {}, false, false},
           {{{4, 3}, {5, 7}}, {{5, 7}}, false, true},
           {{{4, 3}, {5, 7}}, {{5, 7}, {4, 3}}, false, false},  // both were added
           {{{5, 4}, {5, 7}}, {{5, 7}}, false, false},          // the near one is in front
           {{{3, 7}, {4, 3}}, {{3, 7}}, false, false},          // the far one is at the side
       }) {
    Segment segment = LooksEast(row.shown);
    for (const Cell cell : row.flipped) Flip(segment, cell);
    CAPTURE(row.shown.size(), row.flipped.size());
    CHECK(ShowsMisplacedNearWall(segment) == row.misplaced_near);
    CHECK(ShowsPreferredFarWall(segment) == row.preferred_far);
  }
}

TEST_CASE("Both cases come first, then the segments where the models differ most",
          "[figure_segments]") {
  EvaluationData data;
  Trajectory& trajectory = data.test.trajectories.emplace_back();
  for (int i = 0; i < 3; ++i) trajectory.segments.push_back(LooksEast({}));
  Segment misplaced = LooksEast({{5, 4}});
  Flip(misplaced, {5, 5});
  Segment preferred = LooksEast({{4, 3}, {5, 7}});
  Flip(preferred, {5, 7});
  trajectory.segments.push_back(misplaced);
  trajectory.segments.push_back(preferred);
  ModelRow first;
  ModelRow second;
  for (const Segment& segment : trajectory.segments) {
    first.answers.push_back(ZeroAnswer(segment));
    second.answers.push_back(ZeroAnswer(segment));
  }
  second.answers[1].add[{3, 3}] = 0.5F;
  second.answers[2].remove[{3, 3}] = 0.75F;
  CHECK(Difference(first.answers[2], second.answers[2]) == 0.75);
  const auto chosen = ChooseFigureSegments(data, first, second, 4);
  REQUIRE(chosen.size() == 4);
  CHECK(chosen[0].index == 3);
  CHECK(chosen[1].index == 4);
  CHECK(chosen[2].index == 2);
  CHECK(chosen[3].index == 1);
  CHECK_THAT(chosen[0].reason, Catch::Contains("misplaced"));
  CHECK(ChooseFigureSegments(data, first, second, 10).size() == 5);
  CHECK(ChooseFigureSegments({}, {}, {}).empty());
}

}  // namespace
}  // namespace conav::nhpm
