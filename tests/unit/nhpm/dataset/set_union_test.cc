#include <catch2/catch.hpp>

#include "nhpm/dataset/set_summary.h"
#include "unit/common/segments/support/sample_segments.h"

namespace conav::nhpm {
namespace {

using tests::SampleTrajectory;

/// What is said when `b` joins `a`; empty when it may.
std::string Refusal(const Trajectory& a, const Trajectory& b) {
  SetUnion all;
  REQUIRE(all.Add({{a}}, "a"));
  const auto added = all.Add({{b}}, "b");
  return added ? "" : added.error().text;
}

TEST_CASE("sets are joined unless a trajectory comes twice", "[nhpm][dataset]") {
  SetUnion all;
  REQUIRE(all.Add({{SampleTrajectory(1), SampleTrajectory(2)}}, "a"));
  REQUIRE(all.Add({{SampleTrajectory(3)}}, "b"));
  SetUnion joined = all;
  CHECK(joined.Take() ==
        SegmentSet{{SampleTrajectory(1), SampleTrajectory(2), SampleTrajectory(3)}});
  const auto again = all.Add({{SampleTrajectory(4), SampleTrajectory(2)}}, "c");
  REQUIRE_FALSE(again);
  CHECK(again.error().code == ErrorCode::kRefused);
  CHECK(again.error().text == "c: trajectory 1 is the same as a: trajectory 1");
}

TEST_CASE("a trajectory that comes twice within one set is found", "[nhpm][dataset]") {
  SetUnion all;
  const auto added =
      all.Add({{SampleTrajectory(1), SampleTrajectory(2), SampleTrajectory(1)}}, "a");
  REQUIRE_FALSE(added);
  CHECK(added.error().text == "a: trajectory 2 is the same as a: trajectory 0");
}

TEST_CASE("a trajectory that was recorded again is the same", "[nhpm][dataset]") {
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
  CHECK(Refusal(SampleTrajectory(), again) == "b: trajectory 0 is the same as a: trajectory 0");
}

TEST_CASE("the recovered beginning of a trajectory is the same, in either order",
          "[nhpm][dataset]") {
  Trajectory torn = SampleTrajectory();
  torn.segments.pop_back();
  CHECK_FALSE(Refusal(SampleTrajectory(), torn).empty());
  CHECK_FALSE(Refusal(torn, SampleTrajectory()).empty());
}

TEST_CASE("another person, world, seed, map or picture is another trajectory", "[nhpm][dataset]") {
  const auto joins = [](auto change) {
    Trajectory other = SampleTrajectory();
    change(other);
    return Refusal(SampleTrajectory(), other).empty();
  };
  CHECK(joins([](Trajectory& t) { t.origin = SegmentOrigin::kPerson; }));
  CHECK(joins([](Trajectory& t) { t.participant = "p08"; }));
  CHECK(joins([](Trajectory& t) { t.world = "conav15"; }));
  CHECK(joins([](Trajectory& t) { ++t.world_seed; }));
  CHECK(joins([](Trajectory& t) { --t.corruption_seed; }));
  CHECK(joins([](Trajectory& t) { ++t.annotator_seed; }));
  CHECK(joins([](Trajectory& t) { t.segments[1].query.belief[{2, 2}] = 1.0F; }));
  CHECK(joins([](Trajectory& t) { t.segments[0].belief_after[{2, 2}] = 1.0F; }));
  CHECK(joins(
      [](Trajectory& t) { t.segments[0].query.path.erase(t.segments[0].query.path.begin()); }));
  CHECK(joins([](Trajectory& t) { t.segments[0].query.visible.walls.pop_back(); }));
}

}  // namespace
}  // namespace conav::nhpm
