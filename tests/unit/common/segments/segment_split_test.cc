#include "common/segments/segment_split.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <set>

#include "unit/common/segments/support/sample_segments.h"

namespace conav {
namespace {

SegmentSet Many(std::size_t count) {
  SegmentSet set;
  for (std::size_t i = 0; i < count; ++i) {
    set.trajectories.push_back(tests::SampleTrajectory(i));
  }
  return set;
}

std::set<std::uint64_t> Seeds(const SegmentSet& set) {
  std::set<std::uint64_t> seeds;
  for (const Trajectory& trajectory : set.trajectories) seeds.insert(trajectory.world_seed);
  return seeds;
}

TEST_CASE("113 trajectories split 95 to 5 with a tenth of the training for validation",
          "[segments]") {
  const SegmentSplit split = SplitSegments(Many(113), 1);
  CHECK(split.test.trajectories.size() == 6);
  CHECK(split.validation.trajectories.size() == 11);
  CHECK(split.train.trajectories.size() == 96);
  std::set<std::uint64_t> all = Seeds(split.train);
  all.merge(Seeds(split.validation));
  all.merge(Seeds(split.test));
  CHECK(all.size() == 113);
}

TEST_CASE("the split depends on the seed, not on the order of the trajectories, and keeps it",
          "[segments]") {
  SegmentSet set = Many(40);
  const SegmentSplit split = SplitSegments(set, 5);
  CHECK(std::ranges::is_sorted(split.train.trajectories, {}, &Trajectory::world_seed));
  std::ranges::reverse(set.trajectories);
  const SegmentSplit reversed = SplitSegments(set, 5);
  CHECK(Seeds(split.train) == Seeds(reversed.train));
  CHECK(Seeds(split.validation) == Seeds(reversed.validation));
  CHECK(Seeds(split.test) == Seeds(reversed.test));
  CHECK(Seeds(split.validation) != Seeds(SplitSegments(set, 6).validation));
}

TEST_CASE("each part gets a trajectory, whatever its share, training comes first", "[segments]") {
  using Sizes = std::vector<std::size_t>;
  const auto sizes = [](std::size_t count, const SplitShares& shares = {}) {
    const SegmentSplit split = SplitSegments(Many(count), 3, shares);
    return Sizes{split.train.trajectories.size(), split.validation.trajectories.size(),
                 split.test.trajectories.size()};
  };
  CHECK(sizes(0) == Sizes{0, 0, 0});
  CHECK(sizes(1) == Sizes{1, 0, 0});
  CHECK(sizes(2) == Sizes{1, 0, 1});
  CHECK(sizes(3) == Sizes{1, 1, 1});
  CHECK(sizes(10, {.test = 1.0, .validation = 1.0}) == Sizes{1, 1, 8});
}

TEST_CASE("a fingerprint is the one that weights files of before keep", "[segments]") {
  CHECK(FingerprintOf(tests::SampleTrajectory(7)) == 0xac492bdf54a2eae9ULL);
}

TEST_CASE("every difference between trajectories changes the fingerprint", "[segments]") {
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
