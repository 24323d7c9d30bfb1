#include "common/segments/segment_split.h"

#include <algorithm>
#include <cmath>

#include "common/runtime/random.h"
#include "common/segments/trajectory_fingerprint.h"

namespace conav {
namespace {

/// Indices of the trajectories in the order in which test, validation and training take them.
std::vector<std::size_t> Order(const SegmentSet& set, std::uint64_t seed) {
  std::vector<std::pair<std::uint64_t, std::size_t>> keys;
  for (std::size_t i = 0; i < set.trajectories.size(); ++i) {
    keys.emplace_back(DeriveSeed(seed, FingerprintOf(set.trajectories[i])), i);
  }
  std::ranges::sort(keys);
  std::vector<std::size_t> order;
  for (const auto& [key, index] : keys) order.push_back(index);
  return order;
}

std::size_t ShareOf(std::size_t count, double share) {
  return static_cast<std::size_t>(std::lround(static_cast<double>(count) * share));
}

struct Counts {
  std::size_t test = 0;
  std::size_t validation = 0;
};

Counts CountsFor(std::size_t all, const SplitShares& shares) {
  if (all < 3) return {all > 1 ? 1U : 0U, 0U};
  Counts counts;
  counts.test = std::clamp(ShareOf(all, shares.test), std::size_t{1}, all - 2);
  const std::size_t rest = all - counts.test;
  counts.validation = std::clamp(ShareOf(rest, shares.validation), std::size_t{1}, rest - 1);
  return counts;
}

}  // namespace

SegmentSplit SplitSegments(const SegmentSet& set, std::uint64_t seed, const SplitShares& shares) {
  DEMAND(shares.test >= 0.0 && shares.test <= 1.0, shares.test);
  DEMAND(shares.validation >= 0.0 && shares.validation <= 1.0, shares.validation);
  const std::vector<std::size_t> order = Order(set, seed);
  const Counts counts = CountsFor(order.size(), shares);
  SegmentSplit split;
  std::vector<SegmentSet*> part(order.size(), &split.train);
  for (std::size_t i = 0; i < counts.test + counts.validation; ++i) {
    part[order[i]] = i < counts.test ? &split.test : &split.validation;
  }
  for (std::size_t i = 0; i < part.size(); ++i) {
    part[i]->trajectories.push_back(set.trajectories[i]);
  }
  return split;
}

}  // namespace conav
