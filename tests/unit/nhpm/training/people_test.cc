#include <catch2/catch.hpp>

#include "nhpm/training/adapt.h"

namespace conav::nhpm {
namespace {

Segment SmallSegment() {
  Segment segment;
  segment.query.belief = BeliefGrid(3, 3, 1.0F);
  segment.query.path = {{1, 1}};
  segment.query.cell = {1, 1};
  segment.belief_after = segment.query.belief;
  return segment;
}

Trajectory TrajectoryOf(const std::string& participant, std::size_t segments) {
  Trajectory trajectory;
  trajectory.participant = participant;
  trajectory.segments.assign(segments, SmallSegment());
  return trajectory;
}

SegmentSet AnnaAndBert() {
  return {{TrajectoryOf("anna", 1), TrajectoryOf("bert", 2), TrajectoryOf("anna", 3)}};
}

TEST_CASE("Trajectories are sorted by participant", "[nhpm][training][adapt]") {
  const auto people = PeopleOf(AnnaAndBert());
  REQUIRE(people.size() == 2);
  CHECK(people[0].participant == "anna");
  REQUIRE(people[0].set.trajectories.size() == 2);
  CHECK(people[0].set.trajectories[1].segments.size() == 3);
  CHECK(people[1].participant == "bert");
  CHECK(PeopleOf({}).empty());
}

TEST_CASE("A participant is found by name, the only one without", "[nhpm][training][adapt]") {
  const auto people = PeopleOf(AnnaAndBert());
  CHECK(FindPerson(people, "bert").value().participant == "bert");
  CHECK(FindPerson({people[0]}, "").value().participant == "anna");
}

TEST_CASE("A participant who is not there is refused with who is", "[nhpm][training][adapt]") {
  const auto people = PeopleOf(AnnaAndBert());
  CHECK(FindPerson(people, "carl").error().text ==
        "no participant 'carl'; there are 2 (anna, bert)");
  CHECK_THAT(FindPerson(people, "").error().text, Catch::StartsWith("--participant must say"));
}

TEST_CASE("Of a long list of participants some are named", "[nhpm][training][adapt]") {
  std::vector<Person> people(20, Person{"p", {}});
  CHECK(FindPerson(people, "q").error().text ==
        "no participant 'q'; there are 20 (p, p, p, p, p, p, p, p, ...)");
}

TEST_CASE("Trajectories are held out whole, segments where there is only one trajectory",
          "[nhpm][training][adapt]") {
  const auto people = PeopleOf(AnnaAndBert());
  const auto of_anna = AdaptationGroups(people[0].set, {});
  REQUIRE(of_anna.size() == 2);
  CHECK(of_anna[1].examples.size() == 3);
  const auto of_bert = AdaptationGroups(people[1].set, {});
  REQUIRE(of_bert.size() == 2);
  CHECK(of_bert[0].examples.size() == 1);
  CHECK(of_bert[1].rows == 3);
}

}  // namespace
}  // namespace conav::nhpm
