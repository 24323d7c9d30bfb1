#include "nhpm/dataset/set_summary.h"

#include <fmt/core.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>
#include <utility>

namespace conav::nhpm {
namespace {

/// Computes a Spread.
class Sample {
 public:
  void Add(double value) {
    lowest_ = count_ == 0 ? value : std::min(lowest_, value);
    highest_ = count_ == 0 ? value : std::max(highest_, value);
    sum_ += value;
    ++count_;
  }
  void Add(std::size_t value) { Add(static_cast<double>(value)); }
  Spread spread() const {
    return {lowest_, count_ == 0 ? 0.0 : sum_ / static_cast<double>(count_), highest_};
  }

 private:
  double lowest_ = 0.0;
  double highest_ = 0.0;
  double sum_ = 0.0;
  std::size_t count_ = 0;
};

/// Classifies a segment's edits by place; returns their number.
std::size_t CountEdits(const Segment& segment, SetSummary& summary) {
  const EditLabels labels = LabelsOf(segment);
  const VisibleCells& visible = segment.query.visible;
  std::size_t edits = 0;
  for (std::size_t i = 0; i < labels.add.size(); ++i) {
    if (labels.add.values()[i] + labels.remove.values()[i] == 0) continue;
    ++edits;
    ++(labels.add.values()[i] != 0 ? summary.adds : summary.removes);
    const Cell cell = labels.add.CellAt(i);
    if (std::ranges::binary_search(visible.free, cell) ||
        std::ranges::binary_search(visible.walls, cell)) {
      ++summary.edits_seen;
    } else if (std::ranges::find(segment.query.path, cell) != segment.query.path.end()) {
      ++summary.edits_on_path;
    }
  }
  return edits;
}

void AddSegments(const SegmentSet& set, SetSummary& summary) {
  Sample edits;
  Sample seen;
  Sample path;
  for (const Segment* segment : AllSegments(set)) {
    const std::size_t count = CountEdits(*segment, summary);
    summary.edits += count;
    ++summary.segments_by_edits[std::min(count, kEditBins - 1)];
    summary.images += segment->image.empty() ? 0 : 1;
    edits.Add(count);
    seen.Add(segment->query.visible.free.size() + segment->query.visible.walls.size());
    path.Add(segment->query.path.size());
  }
  summary.edits_per_segment = edits.spread();
  summary.seen_cells = seen.spread();
  summary.path_cells = path.spread();
}

void AddTrajectories(const SegmentSet& set, SetSummary& summary) {
  Sample length;
  Sample initial;
  Sample final;
  Sample mapping;
  std::set<std::string> participants;
  for (const Trajectory& trajectory : set.trajectories) {
    const BeliefGrid& map = trajectory.segments.front().query.belief;
    participants.insert(trajectory.participant);
    ++summary.trajectories_by_origin[conav::ToText(trajectory.origin)];
    ++summary.trajectories_by_world[trajectory.world];
    ++summary.trajectories_by_size[fmt::format("{} x {}", map.rows(), map.columns())];
    length.Add(trajectory.segments.size());
    initial.Add(trajectory.initial_cell_accuracy);
    final.Add(trajectory.final_cell_accuracy);
    mapping.Add(trajectory.final_mapping_accuracy);
    summary.accepted += trajectory.final_mapping_accuracy > kAcceptedMappingAccuracy ? 1 : 0;
    summary.without_truth += trajectory.truth ? 0 : 1;
  }
  summary.participants = participants.size();
  summary.segments_per_trajectory = length.spread();
  summary.initial_cell_accuracy = initial.spread();
  summary.final_cell_accuracy = final.spread();
  summary.final_mapping_accuracy = mapping.spread();
}

// As text.

double Share(std::size_t part, std::size_t whole) {
  return whole == 0 ? 0.0 : static_cast<double>(part) / static_cast<double>(whole);
}

std::string Percent(double share) { return fmt::format("{:.1f} %", share * 100.0); }

std::string List(const std::map<std::string, std::size_t>& counts) {
  std::string text;
  for (const auto& [name, count] : counts) {
    text += fmt::format("{}{} ({})", text.empty() ? "" : ", ",
                        name.empty() ? "without a name" : name, count);
  }
  return text;
}

std::string Range(const Spread& spread) {
  return fmt::format("{:.1f} (from {:.0f} to {:.0f})", spread.mean, spread.lowest, spread.highest);
}

std::string PercentRange(const Spread& spread) {
  return fmt::format("{} (from {} to {})", Percent(spread.mean), Percent(spread.lowest),
                     Percent(spread.highest));
}

/// The warning that precedes any number.
std::string Warning(const SetSummary& summary) {
  std::string text;
  if (summary.trajectories_by_origin.contains("synthetic")) {
    text +=
        "SYNTHETIC: edits drawn by the annotators of `conav dataset synthesize`, not by people\n";
  }
  if (summary.trajectories_by_origin.contains("simulated")) {
    text += "SIMULATED: edits of the simulated operator of a demo, not of people\n";
  }
  return text;
}

std::string Histogram(const SetSummary& summary) {
  constexpr std::size_t kBarLength = 40;
  const std::size_t most = std::ranges::max(summary.segments_by_edits);
  std::string text;
  for (std::size_t i = 0; i < kEditBins; ++i) {
    const std::size_t count = summary.segments_by_edits[i];
    const std::size_t length = most == 0 ? 0 : (count * kBarLength + most - 1) / most;
    text += fmt::format("  {}{} {:>7}  {}\n", i, i + 1 == kEditBins ? "+" : " ", count,
                        std::string(length, '#'));
  }
  return text;
}

nlohmann::ordered_json ToJson(const Spread& spread) {
  return {{"min", spread.lowest}, {"mean", spread.mean}, {"max", spread.highest}};
}

/// Compares the content that training uses; the heading only matters through the seen cells.
bool HaveSameContent(const Segment& a, const Segment& b) {
  return a.query.belief == b.query.belief && a.belief_after == b.belief_after &&
         a.query.path == b.query.path && a.query.cell == b.query.cell &&
         a.query.visible == b.query.visible;
}

bool BeginAlike(const Trajectory& a, const Trajectory& b) {
  const auto both = static_cast<std::ptrdiff_t>(std::min(a.segments.size(), b.segments.size()));
  return std::equal(a.segments.begin(), a.segments.begin() + both, b.segments.begin(),
                    HaveSameContent);
}

}  // namespace

double SetSummary::share_without_edit() const { return Share(segments_by_edits[0], segments); }

SetSummary Summarize(const SegmentSet& set) {
  SetSummary summary;
  summary.origin = OriginText(set);
  summary.trajectories = set.trajectories.size();
  summary.segments = SegmentCount(set);
  AddTrajectories(set, summary);
  AddSegments(set, summary);
  return summary;
}

std::string ToText(const SetSummary& summary) {
  if (summary.trajectories == 0) return "no trajectories\n";
  std::string text = Warning(summary);
  const auto line = [&text](std::string_view name, const std::string& value) {
    text += fmt::format("{:<26}{}\n", name, value);
  };
  line("edits made by", summary.origin);
  line("trajectories",
       fmt::format("{}: {}", summary.trajectories, List(summary.trajectories_by_origin)));
  line("participants", std::to_string(summary.participants));
  line("worlds", List(summary.trajectories_by_world));
  line("map sizes", List(summary.trajectories_by_size));
  line("segments", std::to_string(summary.segments));
  line("  per trajectory", Range(summary.segments_per_trajectory));
  line("  with a picture's file", std::to_string(summary.images));
  line("  cells of path", Range(summary.path_cells));
  line("  cells seen", Range(summary.seen_cells));
  line("edits",
       fmt::format("{}: {} walls added, {} removed", summary.edits, summary.adds, summary.removes));
  line("  in cells seen", Percent(Share(summary.edits_seen, summary.edits)));
  line("  on the path only", Percent(Share(summary.edits_on_path, summary.edits)));
  line("  per segment", fmt::format("{:.2f}", summary.edits_per_segment.mean));
  line("segments without edit", Percent(summary.share_without_edit()));
  line("cells right before", PercentRange(summary.initial_cell_accuracy));
  line("cells right after", PercentRange(summary.final_cell_accuracy));
  line("mapping accuracy", PercentRange(summary.final_mapping_accuracy));
  line("  above 50 %",
       fmt::format("{} of {} trajectories", summary.accepted, summary.trajectories));
  if (summary.without_truth > 0) {
    line("  without a true map",
         fmt::format("{} trajectories: accuracies as their file says", summary.without_truth));
  }
  return text + "segments by number of edits\n" + Histogram(summary);
}

nlohmann::ordered_json ToJson(const SetSummary& summary) {
  return {{"origin", summary.origin},
          {"trajectories", summary.trajectories},
          {"trajectories_by_origin", summary.trajectories_by_origin},
          {"trajectories_by_world", summary.trajectories_by_world},
          {"trajectories_by_size", summary.trajectories_by_size},
          {"trajectories_accepted", summary.accepted},
          {"trajectories_without_truth", summary.without_truth},
          {"participants", summary.participants},
          {"segments", summary.segments},
          {"segments_per_trajectory", ToJson(summary.segments_per_trajectory)},
          {"segments_with_image", summary.images},
          {"segments_by_edits", summary.segments_by_edits},
          {"share_without_edit", summary.share_without_edit()},
          {"path_cells", ToJson(summary.path_cells)},
          {"seen_cells", ToJson(summary.seen_cells)},
          {"edits", summary.edits},
          {"edits_added", summary.adds},
          {"edits_removed", summary.removes},
          {"edits_seen", summary.edits_seen},
          {"edits_on_path", summary.edits_on_path},
          {"edits_per_segment", ToJson(summary.edits_per_segment)},
          {"initial_cell_accuracy", ToJson(summary.initial_cell_accuracy)},
          {"final_cell_accuracy", ToJson(summary.final_cell_accuracy)},
          {"final_mapping_accuracy", ToJson(summary.final_mapping_accuracy)}};
}

Result<void> SetUnion::Add(SegmentSet set, const std::string& name) {
  for (std::size_t i = 0; i < set.trajectories.size(); ++i) {
    Trajectory& added = set.trajectories[i];
    const std::string place = fmt::format("{}: trajectory {}", name, i);
    const Key key{added.origin,     added.participant,     added.world,
                  added.world_seed, added.corruption_seed, added.annotator_seed};
    const auto [begin, end] = indices_.equal_range(key);
    for (auto entry = begin; entry != end; ++entry) {
      if (!BeginAlike(added, all_.trajectories[entry->second])) continue;
      return Fail(ErrorCode::kRefused,
                  fmt::format("{} is the same as {}", place, places_[entry->second]));
    }
    indices_.emplace(key, all_.trajectories.size());
    all_.trajectories.push_back(std::move(added));
    places_.push_back(place);
  }
  return {};
}

}  // namespace conav::nhpm
