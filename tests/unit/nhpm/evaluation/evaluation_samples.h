#pragma once

#include <fmt/format.h>

#include <string>
#include <utility>
#include <vector>

#include "nhpm/evaluation/evaluation.h"
#include "unit/nhpm/evaluation/samples.h"

namespace conav::nhpm {

/// Promises the same everywhere, but for the masks.
class EvenModel final : public PerceptionModel {
 public:
  explicit EvenModel(float probability) : probability_(probability) {}
  Result<std::vector<PerceptionAnswer>> Predict(std::span<const PerceptionQuery> queries) override {
    std::vector<PerceptionAnswer> answers;
    for (const PerceptionQuery& query : queries) {
      const BeliefGrid& map = query.belief;
      PerceptionAnswer& answer = answers.emplace_back(PerceptionAnswer{
          Grid<float>(map.rows(), map.columns()), Grid<float>(map.rows(), map.columns())});
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

/// Segments edited as `people` says, in trajectories of `length`.
template <class Model>
SegmentSet SegmentsOf(Model&& people, int trajectories, int length, std::uint64_t seed) {
  Random random(seed);
  SegmentSet set;
  for (int t = 0; t < trajectories; ++t) {
    Trajectory& trajectory = set.trajectories.emplace_back();
    trajectory.origin = SegmentOrigin::kSynthetic;
    trajectory.participant = fmt::format("p{}", t);
    for (int i = 0; i < length; ++i) {
      Segment segment = RandomSegment(random, 9);
      segment.step = static_cast<std::uint32_t>(i);
      const PerceptionAnswer answer = people.Predict({&segment.query, 1})->front();
      for (std::size_t cell = 0; cell < segment.belief_after.size(); ++cell) {
        if (segment.belief_after.OnBorder(segment.belief_after.CellAt(cell))) continue;
        float& after = segment.belief_after.values()[cell];
        const float edit = after >= 0.5F ? answer.remove.values()[cell] : answer.add.values()[cell];
        if (random.Chance(static_cast<double>(edit))) after = 1.0F - after;
      }
      trajectory.segments.push_back(std::move(segment));
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
