#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "common/grid/grid.h"
#include "common/msg/planning.h"

/// The training data of perception models: how people edited their map after each picture.
namespace conav {

/// One communication event: the operator's map before, what was sent, the operator's map after.
/// Paper Appendix A: (x, tau, o, x').
struct Segment {
  std::uint32_t step = 0;  // of this event within its trajectory, from 0
  /// x is 0 or 1 in each cell; the path ends in the camera's cell.
  PerceptionQuery query;
  BeliefGrid belief_after;  // x', 0 or 1 in each cell, the border as in x
  std::string image;        // file of the picture, relative to the data set; empty = not kept
  std::string image_sha256;
  /// Seconds since the start of the trajectory; empty if not recorded.
  std::optional<double> sent_s;
  std::optional<double> first_edit_s;
  std::optional<double> confirmed_s;
  std::uint32_t goals_reached = 0;
  bool operator==(const Segment&) const = default;
};

/// The origin of the edits.
enum class SegmentOrigin : std::uint8_t {
  kPerson,     // a person at a console
  kSimulated,  // the simulated operator of a demo or a study
  kSynthetic,  // an annotator of `conav dataset synthesize`
};

inline constexpr std::array kSegmentOrigins{SegmentOrigin::kPerson, SegmentOrigin::kSimulated,
                                            SegmentOrigin::kSynthetic};

/// One person on one maze, from the first picture to the last.
struct Trajectory {
  SegmentOrigin origin = SegmentOrigin::kPerson;
  std::string participant;  // a pseudonym
  std::string session;
  std::string world;  // maze preset or map file
  std::uint64_t world_seed = 0;
  std::uint64_t corruption_seed = 0;
  std::optional<OccupancyGrid> truth;
  double initial_cell_accuracy = 0.0;   // MapAccuracy::cell before the first segment
  double final_cell_accuracy = 0.0;     // ... after the last
  double final_mapping_accuracy = 0.0;  // MapAccuracy::mapping after the last
  /// Parameters of a synthetic annotator by name (SnapshotReaderParameters); empty for people.
  std::map<std::string, double> annotator;
  std::uint64_t annotator_seed = 0;
  std::vector<Segment> segments;  // all of one shape, in the order of `step`
  bool operator==(const Trajectory&) const = default;
};

/// Paper Appendix A: trajectories above this final mapping accuracy are kept.
inline constexpr double kAcceptedMappingAccuracy = 0.5;

struct SegmentSet {
  std::vector<Trajectory> trajectories;
  bool operator==(const SegmentSet&) const = default;
};

/// Number of cells that differ between x and x'.
int EditCount(const Segment& segment);

/// What the person did, in the shape of PerceptionAnswer: 1 where the cell was edited.
struct EditLabels {
  Grid<std::uint8_t> add;     // x 0 -> x' 1
  Grid<std::uint8_t> remove;  // x 1 -> x' 0
  bool operator==(const EditLabels&) const = default;
};

/// Labels of a segment that passed CheckSegment.
EditLabels LabelsOf(const Segment& segment);

std::size_t SegmentCount(const SegmentSet& set);

/// The first `count` segments, or all, with their trajectories.
SegmentSet FirstSegments(const SegmentSet& set, std::size_t count);

/// All segments, trajectory by trajectory, without copying; valid while `set` does not change.
std::vector<const Segment*> AllSegments(const SegmentSet& set);

/// Their queries, as PerceptionModel::Predict takes them.
std::vector<PerceptionQuery> Queries(const SegmentSet& set);

/// The origins of a set for reports and weights files: "people", "simulated", "synthetic", or
/// several joined by "+", in this order; "nobody" for an empty set.
std::string OriginText(const SegmentSet& set);

/// "person", "simulated" or "synthetic".
const char* ToText(SegmentOrigin origin);

}  // namespace conav
