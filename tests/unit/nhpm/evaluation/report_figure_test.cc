#include "nhpm/evaluation/report_figure.h"

#include <catch2/catch.hpp>

#include "support/xml_check.h"
#include "unit/nhpm/evaluation/samples.h"

namespace conav::nhpm {
namespace {

std::size_t Count(std::string_view text, std::string_view part) {
  std::size_t count = 0;
  for (auto at = text.find(part); at != std::string_view::npos; at = text.find(part, at + 1))
    ++count;
  return count;
}

TEST_CASE("The map has a square per cell", "[nhpm][report_figure]") {
  const std::string svg = BeforePanel(EmptySegment(4, 5));
  CHECK(Count(svg, "class=\"wall\"") == 14);
  CHECK(Count(svg, "class=\"free\"") == 6);
  CHECK(test::XmlError(svg) == "");
}

TEST_CASE("The picture shows its cells, the path and where the camera looks",
          "[nhpm][report_figure]") {
  Segment segment = EmptySegment();
  segment.query.path = {{1, 2}, {2, 2}};
  segment.query.visible = {{{2, 2}, {2, 3}}, {{2, 4}}};
  const std::string svg = ViewPanel(segment);
  CHECK(Count(svg, "class=\"seen-free\"") == 2);
  CHECK(Count(svg, "class=\"seen-wall\"") == 1);
  CHECK_THAT(svg, Catch::Contains("<polyline points=\"45.0,27.0 45.0,45.0\""));
  CHECK_THAT(svg, Catch::Contains("<polygon points=\"58.5,45.0 "));  // east of (2,2)
}

TEST_CASE("A prediction is as strong as its probability, small ones are left out",
          "[nhpm][report_figure]") {
  const Segment segment = EmptySegment();
  PerceptionAnswer answer = ZeroAnswer(segment);
  answer.add[{1, 1}] = 0.375F;
  answer.add[{1, 2}] = 0.045F;
  answer.remove[{3, 3}] = 0.5F;
  const std::string svg = PredictionPanel(segment, answer, "A & B");
  CHECK_THAT(svg, Catch::Contains("class=\"add\" fill-opacity=\"0.375\""));
  CHECK_THAT(svg, Catch::Contains("class=\"remove\" fill-opacity=\"0.500\""));
  CHECK_THAT(svg, Catch::Contains(">38</text>"));
  CHECK(Count(svg, "fill-opacity") == 2);
  CHECK_THAT(svg, Catch::Contains("A &amp; B: 0.92 edits expected"));
  CHECK(test::XmlError(svg) == "");
}

TEST_CASE("The truth is signed, not only coloured", "[nhpm][report_figure]") {
  Segment segment = EmptySegment();
  segment.query.belief[{1, 1}] = 1.0F;
  Flip(segment, {3, 3});
  const std::string svg = TruthPanel(segment);  // (1,1) is free afterwards: removed
  CHECK(Count(svg, ">+</text>") == 1);
  CHECK(Count(svg, ">\u2212</text>") == 1);
  CHECK_THAT(svg, Catch::Contains("What was done: 2 edits"));
}

}  // namespace
}  // namespace conav::nhpm
