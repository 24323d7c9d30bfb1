#include <catch2/catch.hpp>
#include <limits>

#include "nhpm/evaluation/metrics.h"
#include "unit/nhpm/evaluation/samples.h"

namespace conav::nhpm {
namespace {

TEST_CASE("Each cell inside of the border has the output that x leaves open", "[nhpm][outcomes]") {
  Segment segment = EmptySegment(3, 4);  // inside: (1,1) and (1,2)
  segment.query.belief[{1, 2}] = 1.0F;
  segment.belief_after[{1, 2}] = 0.0F;
  PerceptionAnswer answer = ZeroAnswer(segment);
  answer.add[{1, 1}] = 0.25F;
  answer.remove[{1, 2}] = 0.75F;
  answer.add[{1, 2}] = 0.5F;     // masked: there is a wall
  answer.remove[{0, 0}] = 0.5F;  // masked: the border
  const Segment* pointer = &segment;
  const auto outcomes = PairOutcomes({&pointer, 1}, {&answer, 1});
  REQUIRE(outcomes);
  CHECK(outcomes->values == std::vector<Outcome>{{0.25F, false}, {0.75F, true}});
  CHECK(outcomes->outputs == 24);
  CHECK(outcomes->segments() == 1);
}

TEST_CASE("Outcomes are kept segment by segment", "[nhpm][outcomes]") {
  std::vector<Segment> segments{EmptySegment(3, 3), EmptySegment(3, 4)};
  Flip(segments[1], {1, 2});
  const auto outcomes =
      PairOutcomes(Pointers(segments),
                   std::vector<PerceptionAnswer>{ZeroAnswer(segments[0]), ZeroAnswer(segments[1])});
  REQUIRE(outcomes);
  CHECK(outcomes->Segment(0).size() == 1);
  REQUIRE(outcomes->Segment(1).size() == 2);
  CHECK(outcomes->Segment(1)[1].edited);
  CHECK(outcomes->outputs == 18 + 24);
}

TEST_CASE("No segments have no outcomes", "[nhpm][outcomes]") {
  const auto outcomes = PairOutcomes({}, {});
  REQUIRE(outcomes);
  CHECK(outcomes->values.empty());
}

TEST_CASE("Answers that do not belong to the segments are refused", "[nhpm][outcomes]") {
  const std::vector<Segment> segments{EmptySegment(), EmptySegment()};
  std::vector<PerceptionAnswer> answers{ZeroAnswer(segments[0])};
  CHECK_THAT(PairOutcomes(Pointers(segments), answers).error().text,
             Catch::Contains("1 answers to 2 segments"));
  answers.push_back(ZeroAnswer(EmptySegment(4, 4)));
  CHECK_THAT(PairOutcomes(Pointers(segments), answers).error().text,
             Catch::Contains("segment 1: the answer is 4 x 4"));
  answers[1] = ZeroAnswer(segments[1]);
  answers[1].add[{2, 2}] = std::numeric_limits<float>::quiet_NaN();
  CHECK_THAT(PairOutcomes(Pointers(segments), answers).error().text, Catch::Contains("(2,2)"));
  answers[1].add[{2, 2}] = 1.5F;
  CHECK_FALSE(PairOutcomes(Pointers(segments), answers));
}

}  // namespace
}  // namespace conav::nhpm
