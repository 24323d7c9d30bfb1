#include <catch2/catch.hpp>
#include <set>

#include "common/segments/segment_split.h"
#include "unit/common/segments/support/sample_segments.h"

namespace conav {
namespace {

TEST_CASE("a fingerprint is the one that weights files of before keep", "[segments]") {
  CHECK(FingerprintOf(tests::SampleTrajectory(7)) == 0xac492bdf54a2eae9ULL);
}

TEST_CASE("whatever tells trajectories apart changes the fingerprint", "[segments]") {
  std::set<std::uint64_t> prints{FingerprintOf(tests::SampleTrajectory())};
  const auto changed = [&](auto&& change) {
    Trajectory trajectory = tests::SampleTrajectory();
    change(trajectory);
    return prints.insert(FingerprintOf(trajectory)).second;
  };
  CHECK(changed([](Trajectory& one) { one.participant = "p08"; }));
  CHECK(changed([](Trajectory& one) { one.session = "s2"; }));
  CHECK(changed([](Trajectory& one) { one.world = "conav9"; }));
  CHECK(changed([](Trajectory& one) { one.world_seed = 8; }));
  CHECK(changed([](Trajectory& one) { one.corruption_seed = 8; }));
  CHECK(changed([](Trajectory& one) { one.annotator_seed = 8; }));
  CHECK(changed([](Trajectory& one) { one.segments.pop_back(); }));
  CHECK(changed([](Trajectory& one) { one.segments[1].belief_after[{1, 1}] = 1.0F; }));
  CHECK_FALSE(changed([](Trajectory&) {}));
}

TEST_CASE("known trajectories are counted, in whatever set they are", "[segments]") {
  const SegmentSet old{{tests::SampleTrajectory(1), tests::SampleTrajectory(2)}};
  const SegmentSet other{{tests::SampleTrajectory(3)}};
  const SegmentSet merged{{tests::SampleTrajectory(3), tests::SampleTrajectory(2)}};
  CHECK(CountKnown(merged, FingerprintsOf(old)) == 1);
  CHECK(CountKnown(other, FingerprintsOf(old)) == 0);
  CHECK(CountKnown(merged, {}) == 0);
  const Fingerprints all = Union(FingerprintsOf(old), FingerprintsOf(merged));
  CHECK(all.size() == 3);
  CHECK(CountKnown(merged, all) == 2);
}

}  // namespace
}  // namespace conav
