#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <tuple>
#include <vector>

#include "common/runtime/result.h"
#include "common/segments/segment.h"

namespace conav::nhpm {

/// Joins sets in which no trajectory may come twice: it could be trained on and tested with.
///
/// Two are the same when person, world and seeds are, and the segments of the shorter one are the
/// first ones of the other: so is one that was recorded again, or recovered from a torn file. What
/// a recording says of itself (session, times, pictures, accuracies) makes no difference.
class SetUnion {
 public:
  /// `name` names the set in messages, as a file does. Errors: kRefused (a trajectory is the same as
  /// another, of this set or of one before): the union is of no use then.
  [[nodiscard]] Result<void> Add(SegmentSet set, const std::string& name);

  SegmentSet Take() { return std::move(all_); }

 private:
  /// Origin, participant, world, world_seed, corruption_seed, annotator_seed.
  using Key = std::tuple<SegmentOrigin, std::string, std::string, std::uint64_t, std::uint64_t,
                         std::uint64_t>;

  SegmentSet all_;
  std::vector<std::string> places_;          // of each trajectory: "a.pb.zst: trajectory 3"
  std::multimap<Key, std::size_t> indices_;  // of trajectories in all_
};

}  // namespace conav::nhpm
