#include "common/segments/segment.h"

namespace conav {

int EditCount(const Segment& segment) {
  const auto before = segment.query.belief.values();
  const auto after = segment.belief_after.values();
  DEMAND(before.size() == after.size(), before.size(), after.size());
  int count = 0;
  for (std::size_t i = 0; i < before.size(); ++i) count += before[i] != after[i] ? 1 : 0;
  return count;
}

EditLabels LabelsOf(const Segment& segment) {
  const BeliefGrid& before = segment.query.belief;
  const BeliefGrid& after = segment.belief_after;
  DEMAND(before.size() == after.size(), before.size(), after.size());
  EditLabels labels{{before.rows(), before.columns()}, {before.rows(), before.columns()}};
  for (std::size_t i = 0; i < before.size(); ++i) {
    const bool was_wall = before.values()[i] != 0.0F;
    const bool is_wall = after.values()[i] != 0.0F;
    labels.add.values()[i] = !was_wall && is_wall ? 1 : 0;
    labels.remove.values()[i] = was_wall && !is_wall ? 1 : 0;
  }
  return labels;
}

std::size_t SegmentCount(const SegmentSet& set) {
  std::size_t count = 0;
  for (const Trajectory& trajectory : set.trajectories) count += trajectory.segments.size();
  return count;
}

SegmentSet FirstSegments(const SegmentSet& set, std::size_t count) {
  SegmentSet first;
  for (const Trajectory& trajectory : set.trajectories) {
    const std::size_t left = count - SegmentCount(first);
    if (left == 0) break;
    first.trajectories.push_back(trajectory);
    auto& segments = first.trajectories.back().segments;
    if (segments.size() > left) segments.resize(left);
  }
  return first;
}

std::vector<const Segment*> AllSegments(const SegmentSet& set) {
  std::vector<const Segment*> all;
  all.reserve(SegmentCount(set));
  for (const Trajectory& trajectory : set.trajectories) {
    for (const Segment& segment : trajectory.segments) all.push_back(&segment);
  }
  return all;
}

std::vector<PerceptionQuery> Queries(const SegmentSet& set) {
  std::vector<PerceptionQuery> queries;
  queries.reserve(SegmentCount(set));
  for (const Segment* segment : AllSegments(set)) queries.push_back(segment->query);
  return queries;
}

std::string OriginText(const SegmentSet& set) {
  bool seen[3] = {};
  for (const Trajectory& trajectory : set.trajectories) {
    seen[static_cast<std::size_t>(trajectory.origin)] = true;
  }
  constexpr const char* kNames[3] = {"people", "simulated", "synthetic"};
  std::string text;
  for (std::size_t i = 0; i < 3; ++i) {
    if (!seen[i]) continue;
    if (!text.empty()) text += '+';
    text += kNames[i];
  }
  return text.empty() ? "nobody" : text;
}

const char* ToText(SegmentOrigin origin) {
  constexpr std::array kNames{"person", "simulated", "synthetic"};
  return kNames.at(static_cast<std::size_t>(origin));
}

}  // namespace conav
