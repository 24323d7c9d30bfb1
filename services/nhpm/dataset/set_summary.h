#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <tuple>
#include <vector>

#include "common/runtime/result.h"
#include "common/segments/segment.h"

namespace conav::nhpm {

/// Lowest, mean and highest of a count or a share; zeros when there was none.
struct Spread {
  double lowest = 0.0;
  double mean = 0.0;
  double highest = 0.0;
  bool operator==(const Spread&) const = default;
};

/// Segments by their number of edits: 0, 1, ..., 6, and 7 or more.
inline constexpr std::size_t kEditBins = 8;

/// What `conav dataset describe` says of a set that passed CheckSegments.
struct SetSummary {
  std::string origin;  // OriginText
  std::size_t trajectories = 0;
  std::size_t segments = 0;
  std::size_t participants = 0;  // different names
  std::map<std::string, std::size_t> trajectories_by_origin;
  std::map<std::string, std::size_t> trajectories_by_world;
  std::map<std::string, std::size_t> trajectories_by_size;  // "15 x 15"
  Spread segments_per_trajectory;

  std::size_t edits = 0;
  std::size_t adds = 0;
  std::size_t removes = 0;
  std::size_t edits_seen = 0;     // in cells that the picture shows
  std::size_t edits_on_path = 0;  // in cells of the path that it does not show
  Spread edits_per_segment;
  std::array<std::size_t, kEditBins> segments_by_edits{};

  Spread seen_cells;  // per segment
  Spread path_cells;  // per segment
  std::size_t images = 0;
  Spread initial_cell_accuracy;
  Spread final_cell_accuracy;
  Spread final_mapping_accuracy;
  std::size_t accepted = 0;       // trajectories above kAcceptedMappingAccuracy
  std::size_t without_truth = 0;  // trajectories; their accuracies are what their file says

  double share_without_edit() const;
};

SetSummary Summarize(const SegmentSet& set);

/// Several lines for a terminal; says plainly whose edits these are.
std::string ToText(const SetSummary& summary);
nlohmann::ordered_json ToJson(const SetSummary& summary);

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
