#include "nhpm/evaluation/outcomes.h"

#include <fmt/format.h>

namespace conav::nhpm {
namespace {

Result<void> CheckShape(const Segment& segment, const PerceptionAnswer& answer) {
  const BeliefGrid& belief = segment.query.belief;
  const auto fits = [&](const Grid<float>& grid) {
    return grid.rows() == belief.rows() && grid.columns() == belief.columns();
  };
  if (fits(answer.add) && fits(answer.remove)) return {};
  return Fail(ErrorCode::kInvalidArgument,
              fmt::format("the answer is {} x {} cells, the segment {} x {}", answer.add.rows(),
                          answer.add.columns(), belief.rows(), belief.columns()));
}

Result<void> Append(const Segment& segment, const PerceptionAnswer& answer, Outcomes& outcomes) {
  if (const auto checked = CheckShape(segment, answer); !checked) return checked;
  const BeliefGrid& before = segment.query.belief;
  for (std::size_t i = 0; i < before.size(); ++i) {
    if (before.OnBorder(before.CellAt(i))) continue;
    const bool is_wall = before.values()[i] >= 0.5F;
    const float probability = is_wall ? answer.remove.values()[i] : answer.add.values()[i];
    if (!(probability >= 0.0F && probability <= 1.0F)) {
      return Fail(ErrorCode::kInvalidArgument, fmt::format("probability {} at {} is not in [0, 1]",
                                                           probability, before.CellAt(i)));
    }
    outcomes.values.push_back({probability, is_wall != (segment.belief_after.values()[i] >= 0.5F)});
  }
  outcomes.segment_ends.push_back(outcomes.values.size());
  outcomes.outputs += 2 * before.size();
  return {};
}

}  // namespace

std::span<const Outcome> Outcomes::Segment(std::size_t index) const {
  const std::size_t begin = index == 0 ? 0 : segment_ends[index - 1];
  return std::span(values).subspan(begin, segment_ends[index] - begin);
}

Result<Outcomes> PairOutcomes(std::span<const Segment* const> segments,
                              std::span<const PerceptionAnswer> answers) {
  if (segments.size() != answers.size()) {
    return Fail(ErrorCode::kInvalidArgument,
                fmt::format("{} answers to {} segments", answers.size(), segments.size()));
  }
  Outcomes outcomes;
  for (std::size_t i = 0; i < segments.size(); ++i) {
    const auto appended = Append(*segments[i], answers[i], outcomes);
    if (!appended) {
      return Fail(appended.error().code, fmt::format("segment {}: {}", i, appended.error().text));
    }
  }
  return outcomes;
}

}  // namespace conav::nhpm
