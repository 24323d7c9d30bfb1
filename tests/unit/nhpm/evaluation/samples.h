#pragma once

#include <fmt/core.h>

#include <string>
#include <utility>
#include <vector>

#include "common/runtime/random.h"
#include "common/segments/segment.h"
#include "nhpm/evaluation/evaluation.h"
#include "nhpm/evaluation/metrics.h"

namespace conav::nhpm {

/// rows x columns, border walls, free inside, camera in the middle looking east, nothing edited.
inline Segment EmptySegment(int rows = 5, int columns = 5) {
  Segment segment;
  BeliefGrid map(rows, columns, 0.0F);
  for (std::size_t i = 0; i < map.size(); ++i) {
    if (map.OnBorder(map.CellAt(i))) map.values()[i] = 1.0F;
  }
  segment.query.belief = map;
  segment.query.cell = {rows / 2, columns / 2};
  segment.query.path = {segment.query.cell};
  segment.query.visible.free = {segment.query.cell};
  segment.belief_after = map;
  return segment;
}

inline PerceptionAnswer NoEdits(const BeliefGrid& map) {
  return {Grid<float>(map.rows(), map.columns()), Grid<float>(map.rows(), map.columns())};
}

inline PerceptionAnswer ZeroAnswer(const Segment& segment) { return NoEdits(segment.query.belief); }

inline std::vector<const Segment*> Pointers(const std::vector<Segment>& segments) {
  std::vector<const Segment*> pointers;
  for (const Segment& segment : segments) pointers.push_back(&segment);
  return pointers;
}

inline void Flip(Segment& segment, Cell cell) {
  segment.belief_after[cell] = 1.0F - segment.query.belief[cell];
}

/// Outcomes of segments with the same number of unmasked outputs each; half of all are masked.
inline Outcomes MakeOutcomes(const std::vector<std::vector<Outcome>>& segments) {
  Outcomes outcomes;
  for (const auto& segment : segments) {
    outcomes.values.insert(outcomes.values.end(), segment.begin(), segment.end());
    outcomes.segment_ends.push_back(outcomes.values.size());
    outcomes.outputs += 2 * segment.size();
  }
  return outcomes;
}

/// A map of random walls, a path of two cells and a picture of a random part of it.
inline Segment RandomSegment(Random& random) {
  Segment segment = EmptySegment(9, 9);
  PerceptionQuery& query = segment.query;
  query.cell.row = static_cast<int>(random.Uniform(1, 7));
  query.cell.column = static_cast<int>(random.Uniform(1, 6));
  query.path = {{query.cell.row, query.cell.column + 1}, query.cell};
  query.visible = {};
  for (std::size_t i = 0; i < query.belief.size(); ++i) {
    const Cell cell = query.belief.CellAt(i);
    if (query.belief.OnBorder(cell)) continue;
    query.belief.values()[i] = random.Chance(0.3) ? 1.0F : 0.0F;
    const bool shown = random.Chance(0.4);
    const bool is_wall = random.Chance(0.3);
    if (shown) (is_wall ? query.visible.walls : query.visible.free).push_back(cell);
  }
  segment.belief_after = query.belief;
  return segment;
}

/// Promises the same everywhere, but for the masks.
class EvenModel final : public PerceptionModel {
 public:
  explicit EvenModel(float probability) : probability_(probability) {}
  Result<std::vector<PerceptionAnswer>> Predict(std::span<const PerceptionQuery> queries) override {
    std::vector<PerceptionAnswer> answers;
    for (const PerceptionQuery& query : queries) {
      const BeliefGrid& map = query.belief;
      PerceptionAnswer& answer = answers.emplace_back(NoEdits(map));
      for (std::size_t i = 0; i < map.size(); ++i) {
        if (map.OnBorder(map.CellAt(i))) continue;
        (map.values()[i] >= 0.5F ? answer.remove : answer.add).values()[i] = probability_;
      }
    }
    return answers;
  }
  ModelIdentity identity() const override { return identity_; }

 private:
  float probability_;
  ModelIdentity identity_{"even", "1", std::string(64, '0')};
};

/// Segments edited at random as `people` says, in trajectories of `length`.
inline SegmentSet SegmentsOf(PerceptionModel& people, int trajectories, int length,
                             std::uint64_t seed) {
  Random random(seed);
  SegmentSet set;
  for (int t = 0; t < trajectories; ++t) {
    Trajectory& trajectory = set.trajectories.emplace_back();
    trajectory.origin = SegmentOrigin::kSynthetic;
    trajectory.participant = fmt::format("p{}", t);
    for (int i = 0; i < length; ++i) {
      Segment& segment = trajectory.segments.emplace_back(RandomSegment(random));
      segment.step = static_cast<std::uint32_t>(i);
      const PerceptionAnswer answer = people.Predict({&segment.query, 1})->front();
      for (std::size_t at = 0; at < segment.belief_after.size(); ++at) {
        const float edit = answer.add.values()[at] + answer.remove.values()[at];
        float& after = segment.belief_after.values()[at];
        if (random.Chance(static_cast<double>(edit))) after = 1.0F - after;
      }
    }
  }
  return set;
}

/// People who are a GLPF themselves: 12 trajectories to learn from, 4 to test on.
inline EvaluationData SampleData() {
  Glpf people({.alpha_d = 0.2, .alpha_m = 0.4, .beta = 12.0, .rho = 0.01, .lambda = 0.2});
  EvaluationData data;
  data.train = SegmentsOf(people, 12, 10, 1);
  data.test = SegmentsOf(people, 4, 10, 2);
  data.file = "people.pb.zst";
  data.checksum = std::string(64, 'a');
  data.split_seed = 5;
  return data;
}

}  // namespace conav::nhpm
