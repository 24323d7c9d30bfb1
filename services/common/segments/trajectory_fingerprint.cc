#include "common/segments/trajectory_fingerprint.h"

#include <algorithm>
#include <iterator>
#include <string_view>

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
  std::ranges::sort(prints);
  const auto repeated = std::ranges::unique(prints);
  prints.erase(repeated.begin(), repeated.end());
  return prints;
}

Fingerprints Union(const Fingerprints& a, const Fingerprints& b) {
  Fingerprints all;
  std::ranges::set_union(a, b, std::back_inserter(all));
  return all;
}

std::size_t CountKnown(const SegmentSet& set, const Fingerprints& known) {
  return static_cast<std::size_t>(
      std::ranges::count_if(set.trajectories, [&](const Trajectory& trajectory) {
        return std::ranges::binary_search(known, FingerprintOf(trajectory));
      }));
}

}  // namespace conav
