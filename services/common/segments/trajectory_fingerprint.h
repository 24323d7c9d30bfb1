#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "common/segments/segment.h"

namespace conav {

/// FNV-1a over everything that tells trajectories apart: names, seeds, and the maps before and after
/// each picture. Weights files keep it, so that it never changes.
std::uint64_t FingerprintOf(const Trajectory& trajectory);

/// Fingerprints of trajectories, ascending, each once.
using Fingerprints = std::vector<std::uint64_t>;

Fingerprints FingerprintsOf(const SegmentSet& set);

/// Those of either.
Fingerprints Union(const Fingerprints& a, const Fingerprints& b);

/// How many trajectories of `set` are among `known`.
std::size_t CountKnown(const SegmentSet& set, const Fingerprints& known);

}  // namespace conav
