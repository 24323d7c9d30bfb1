#include "nhpm/dataset/set_summary.h"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "unit/common/segments/support/sample_segments.h"

namespace conav::nhpm {
namespace {

TEST_CASE("a set is counted by origin, size and edits", "[dataset]") {
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

TEST_CASE("edits on the path count apart, many edits share the last bin", "[dataset]") {
  SegmentSet set{{tests::SampleTrajectory()}};
  for (Segment& segment : set.trajectories[0].segments) {
    segment.query.path = {{2, 1}, {1, 2}};
  }
  CHECK(Summarize(set).edits_on_path == 2);
  Segment segment = tests::SampleSegment();
  segment.query.belief = segment.belief_after = BeliefGrid(5, 6);
  segment.query.visible = {};
  for (int i = 0; i < 9; ++i) segment.belief_after[{1 + i / 4, 1 + i % 4}] = 1.0F;
  Trajectory trajectory;
  trajectory.segments = {segment};
  CHECK(Summarize({{trajectory}}).segments_by_edits[kEditBins - 1] == 1);
}

TEST_CASE("nobody can overlook that data is synthetic or simulated", "[dataset]") {
  SegmentSet set{{tests::SampleTrajectory()}};
  CHECK_THAT(ToText(Summarize(set)), Catch::StartsWith("SYNTHETIC: "));
  CHECK(ToJson(Summarize(set)).at("origin") == "synthetic");
  set.trajectories[0].origin = SegmentOrigin::kSimulated;
  CHECK_THAT(ToText(Summarize(set)), Catch::StartsWith("SIMULATED: "));
  set.trajectories[0].origin = SegmentOrigin::kPerson;
  CHECK_THAT(ToText(Summarize(set)), Catch::StartsWith("edits made by             people\n"));
  CHECK(ToText(Summarize({})) == "no trajectories\n");
  CHECK(ToJson(Summarize({})).at("share_without_edit") == 0.0);
}

using tests::SampleTrajectory;

bool AreSame(const Trajectory& a, const Trajectory& b) {
  SetUnion all;
  REQUIRE(all.Add({{a}}, "a"));
  return !all.Add({{b}}, "b");
}

TEST_CASE("sets are joined unless a trajectory comes twice, also within one set", "[dataset]") {
  SetUnion all;
  REQUIRE(all.Add({{SampleTrajectory(1), SampleTrajectory(2)}}, "a"));
  REQUIRE(all.Add({{SampleTrajectory(3)}}, "b"));
  SetUnion joined = all;
  CHECK(joined.Take() ==
        SegmentSet{{SampleTrajectory(1), SampleTrajectory(2), SampleTrajectory(3)}});
  for (const std::uint64_t known : {2, 4}) {
    SetUnion more = all;
    const auto again = more.Add({{SampleTrajectory(4), SampleTrajectory(known)}}, "c");
    REQUIRE_FALSE(again);
    CHECK(again.error().code == ErrorCode::kRefused);
    CHECK_THAT(again.error().text,
               Catch::StartsWith("c: trajectory 1") &&
                   Catch::EndsWith(known == 2 ? "a: trajectory 1" : "c: trajectory 0"));
  }
}

TEST_CASE("a trajectory that was recorded again or torn is the same, in either order",
          "[dataset]") {
  Trajectory again = SampleTrajectory();
  again.session = "s2";
  again.final_cell_accuracy = 0.5;
  again.truth.reset();
  for (Segment& segment : again.segments) {
    segment.step += 5;
    segment.image = "images/other.jpg";
    segment.image_sha256 = std::string(64, 'b');
    segment.confirmed_s = 60.0;
    segment.query.heading_rad += 0.001;
  }
  CHECK(AreSame(SampleTrajectory(), again));
  Trajectory torn = SampleTrajectory();
  torn.segments.pop_back();
  CHECK(AreSame(SampleTrajectory(), torn));
  CHECK(AreSame(torn, SampleTrajectory()));
}

TEST_CASE("another person, world, seed, map or picture is another trajectory", "[dataset]") {
  void (*const changes[])(Trajectory&) = {
      [](Trajectory& t) { t.origin = SegmentOrigin::kPerson; },
      [](Trajectory& t) { t.participant = "p08"; },
      [](Trajectory& t) { t.world = "conav15"; },
      [](Trajectory& t) { ++t.world_seed; },
      [](Trajectory& t) { --t.corruption_seed; },
      [](Trajectory& t) { ++t.annotator_seed; },
      [](Trajectory& t) { t.segments[1].query.belief.values()[12] = 1.0F; },
      [](Trajectory& t) { t.segments[0].belief_after.values()[12] = 1.0F; },
      [](Trajectory& t) { t.segments[0].query.path.pop_back(); },
      [](Trajectory& t) { t.segments[0].query.visible.walls.pop_back(); }};
  for (std::size_t row = 0; row < std::size(changes); ++row) {
    Trajectory other = SampleTrajectory();
    changes[row](other);
    CAPTURE(row);
    CHECK_FALSE(AreSame(SampleTrajectory(), other));
  }
}

}  // namespace
}  // namespace conav::nhpm
