#include "common/segments/segment.h"

#include <catch2/catch.hpp>

#include "unit/common/segments/support/sample_segments.h"

namespace conav {
namespace {

TEST_CASE("labels are 1 where a wall was added or removed, and nowhere else", "[segments]") {
  const EditLabels labels = LabelsOf(tests::SampleSegment());
  Grid<std::uint8_t> add(4, 5);
  Grid<std::uint8_t> remove(4, 5);
  add[{2, 1}] = 1;
  remove[{1, 3}] = 1;
  CHECK(labels == EditLabels{add, remove});
  CHECK(EditCount(tests::SampleSegment()) == 2);
}

TEST_CASE("queries and segments come trajectory by trajectory", "[segments]") {
  const SegmentSet set = tests::SampleSet();
  CHECK(SegmentCount(set) == 3);
  const auto all = AllSegments(set);
  const auto queries = Queries(set);
  REQUIRE(all.size() == 3);
  REQUIRE(queries.size() == 3);
  CHECK(all[2] == &set.trajectories[1].segments[0]);
  CHECK(queries[2] == set.trajectories[1].segments[0].query);
  CHECK(Queries({}).empty());
}

TEST_CASE("a set names everybody who made its edits", "[segments]") {
  SegmentSet set;
  CHECK(OriginText(set) == "nobody");
  set.trajectories.push_back({.origin = SegmentOrigin::kSynthetic});
  CHECK(OriginText(set) == "synthetic");
  set.trajectories.push_back({.origin = SegmentOrigin::kPerson});
  CHECK(OriginText(set) == "people+synthetic");
  set.trajectories.push_back({.origin = SegmentOrigin::kSimulated});
  CHECK(OriginText(set) == "people+simulated+synthetic");
}

}  // namespace
}  // namespace conav
