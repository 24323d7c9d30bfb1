#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "common/segments/segment.h"

namespace conav {

/// FNV-1a over everything that distinguishes trajectories: names, seeds, and the maps before and
/// after each picture. Weights files store it, so it never changes.
std::uint64_t FingerprintOf(const Trajectory& trajectory);

/// Fingerprints of trajectories, ascending, each once.
using Fingerprints = std::vector<std::uint64_t>;

Fingerprints FingerprintsOf(const SegmentSet& set);

/// The fingerprints of either.
Fingerprints Union(const Fingerprints& a, const Fingerprints& b);

/// How many trajectories of `set` are among `known`.
std::size_t CountKnown(const SegmentSet& set, const Fingerprints& known);

struct SegmentSplit {
  SegmentSet train;
  SegmentSet validation;
  SegmentSet test;
};

struct SplitShares {
  double test = 0.05;        // of all trajectories
  double validation = 0.10;  // of the trajectories outside of test
};

/// The default of `conav train`, `conav evaluate` and `conav dataset split`.
inline constexpr std::uint64_t kDefaultSplitSeed = 1;

/// Splits by trajectory, never within one: paper Appendix A (95 % training, 5 % test), with a part
/// of the training trajectories for validation.
///
/// The split depends on `seed` and on the trajectories themselves, not on their order in `set`;
/// within a part they keep that order. With three or more trajectories each part has at least one;
/// with fewer, training goes first, then test. Shares are in [0, 1] (demanded).
SegmentSplit SplitSegments(const SegmentSet& set, std::uint64_t seed,
                           const SplitShares& shares = {});

}  // namespace conav
