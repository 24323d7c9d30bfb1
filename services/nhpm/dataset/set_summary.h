#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>
#include <string_view>
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

/// The summary of a set that passed CheckSegments, for `conav dataset describe`.
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
  std::size_t without_truth = 0;  // trajectories; their accuracies come from their file

  double share_without_edit() const;
};

SetSummary Summarize(const SegmentSet& set);

/// Several lines for a terminal, including a plain statement of the origin of the edits.
std::string ToText(const SetSummary& summary);
nlohmann::ordered_json ToJson(const SetSummary& summary);

/// Joins sets without repeated trajectories: training and testing on the same one would be wrong.
///
/// Two trajectories are the same when person, world and seeds are, and the segments of the shorter
/// one are the first ones of the other. That covers a repeated recording and one recovered from a
/// torn file. Session, times, pictures and accuracies make no difference.
class SetUnion {
 public:
  /// Messages call the set `name`, such as its file. Errors: kRefused when a trajectory repeats one
  /// of this set or an earlier one; the union is unusable then.
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

/// Pictures of a few segments: the map before with path and camera, what the picture shows, the map
/// after with its edits.
namespace conav::nhpm {

/// A segment and its origin.
struct ChosenSegment {
  std::size_t index = 0;  // in the set, over all trajectories
  std::size_t trajectory = 0;
  const Segment* segment = nullptr;
  SegmentOrigin origin = SegmentOrigin::kPerson;
};

/// The segments with these indices. Errors: kOutOfRange names index and limit.
[[nodiscard]] Result<std::vector<ChosenSegment>> ChooseSegments(
    const SegmentSet& set, std::span<const std::size_t> indices);

/// Up to `count` segments with edits, evenly spread over the set; if there are too few, all of them
/// plus others, also spread. In the order of the set.
std::vector<ChosenSegment> ChooseSegments(const SegmentSet& set, std::size_t count);

/// An SVG document, one row for each segment; each row states the origin of the edits.
std::string SegmentsSvg(std::span<const ChosenSegment> chosen, std::string_view title);

/// The same in characters:
///   #  wall       before: o path, > ^ < v camera       shown: . seen free, # seen wall
///                 after:  + wall added, - wall removed
std::string SegmentText(const ChosenSegment& chosen);

}  // namespace conav::nhpm
