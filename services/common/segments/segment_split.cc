#include "common/segments/segment_split.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <string_view>

#include "common/runtime/random.h"

namespace conav {
namespace {

class Fingerprint {
 public:
  void Add(std::uint8_t byte) { hash_ = (hash_ ^ byte) * 0x100000001b3ULL; }
  void Add(std::uint64_t number) {
    for (int shift = 0; shift < 64; shift += 8) Add(static_cast<std::uint8_t>(number >> shift));
  }
  void Add(std::string_view text) {
    for (const char character : text) Add(static_cast<std::uint8_t>(character));
    Add(static_cast<std::uint64_t>(text.size()));
  }
  void Add(const BeliefGrid& map) {
    for (const float value : map.values()) Add(static_cast<std::uint8_t>(value != 0.0F));
  }
  std::uint64_t value() const { return hash_; }

 private:
  std::uint64_t hash_ = 0xcbf29ce484222325ULL;
};

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

std::uint64_t FingerprintOf(const Trajectory& trajectory) {
  Fingerprint print;
  print.Add(trajectory.participant);
  print.Add(trajectory.session);
  print.Add(trajectory.world);
  print.Add(trajectory.world_seed);
  print.Add(trajectory.corruption_seed);
  print.Add(trajectory.annotator_seed);
  for (const Segment& segment : trajectory.segments) {
    print.Add(segment.query.belief);
    print.Add(segment.belief_after);
  }
  return print.value();
}

Fingerprints FingerprintsOf(const SegmentSet& set) {
  Fingerprints prints;
  for (const Trajectory& trajectory : set.trajectories) prints.push_back(FingerprintOf(trajectory));
  std::sort(prints.begin(), prints.end());
  prints.erase(std::unique(prints.begin(), prints.end()), prints.end());
  return prints;
}

Fingerprints Union(const Fingerprints& a, const Fingerprints& b) {
  Fingerprints all;
  std::set_union(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(all));
  return all;
}

std::size_t CountKnown(const SegmentSet& set, const Fingerprints& known) {
  const auto is_known = [&](const Trajectory& trajectory) {
    return std::binary_search(known.begin(), known.end(), FingerprintOf(trajectory));
  };
  return static_cast<std::size_t>(
      std::count_if(set.trajectories.begin(), set.trajectories.end(), is_known));
}

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
