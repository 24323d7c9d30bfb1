#include "nhpm/dataset/set_summary.h"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "unit/common/segments/support/sample_segments.h"

namespace conav::nhpm {
namespace {

TEST_CASE("a set is counted by origin, size and edits", "[nhpm][dataset]") {
  SegmentSet set = tests::SampleSet();
  set.trajectories[0].segments[1].belief_after = set.trajectories[0].segments[1].query.belief;
  const SetSummary summary = Summarize(set);
  CHECK(summary.origin == "people+synthetic");
  CHECK(summary.trajectories == 2);
  CHECK(summary.segments == 3);
  CHECK(summary.participants == 2);
  CHECK(summary.trajectories_by_size == std::map<std::string, std::size_t>{{"4 x 5", 2}});
  CHECK(summary.segments_per_trajectory == Spread{1.0, 1.5, 2.0});
  CHECK(summary.edits == 4);
  CHECK(summary.adds == 2);
  CHECK(summary.removes == 2);
  CHECK(summary.edits_seen == 2);  // (1,3); (2,1) is neither seen nor on the path
  CHECK(summary.edits_on_path == 0);
  CHECK(summary.segments_by_edits[0] == 1);
  CHECK(summary.segments_by_edits[2] == 2);
  CHECK(summary.share_without_edit() == Approx(1.0 / 3.0));
  CHECK(summary.seen_cells == Spread{5.0, 5.0, 5.0});
  CHECK(summary.path_cells == Spread{2.0, 2.0, 2.0});
  CHECK(summary.images == 2);
  CHECK(summary.accepted == 1);
  CHECK(summary.without_truth == 1);
}

TEST_CASE("an edit on the path that the picture does not show is told apart", "[nhpm][dataset]") {
  SegmentSet set{{tests::SampleTrajectory()}};
  for (Segment& segment : set.trajectories[0].segments) {
    segment.query.path = {{2, 1}, {1, 2}};
  }
  CHECK(Summarize(set).edits_on_path == 2);
}

TEST_CASE("many edits share the last bin", "[nhpm][dataset]") {
  Segment segment = tests::SampleSegment();
  segment.query.belief = segment.belief_after = BeliefGrid(5, 6);
  segment.query.visible = {};
  for (int i = 0; i < 9; ++i) segment.belief_after[{1 + i / 4, 1 + i % 4}] = 1.0F;
  Trajectory trajectory;
  trajectory.segments = {segment};
  CHECK(Summarize({{trajectory}}).segments_by_edits[kEditBins - 1] == 1);
}

TEST_CASE("nobody can overlook that data is synthetic or simulated", "[nhpm][dataset]") {
  SegmentSet set{{tests::SampleTrajectory()}};
  CHECK_THAT(ToText(Summarize(set)), Catch::StartsWith("SYNTHETIC: "));
  CHECK(ToJson(Summarize(set)).at("origin") == "synthetic");
  set.trajectories[0].origin = SegmentOrigin::kSimulated;
  CHECK_THAT(ToText(Summarize(set)), Catch::StartsWith("SIMULATED: "));
  set.trajectories[0].origin = SegmentOrigin::kPerson;
  CHECK_THAT(ToText(Summarize(set)), Catch::StartsWith("edits made by             people\n"));
}

TEST_CASE("an empty set has no numbers and no failure", "[nhpm][dataset]") {
  CHECK(ToText(Summarize({})) == "no trajectories\n");
  CHECK(ToJson(Summarize({})).at("share_without_edit") == 0.0);
}

}  // namespace
}  // namespace conav::nhpm
