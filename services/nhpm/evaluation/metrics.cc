#include "nhpm/evaluation/metrics.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

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

struct Overlap {
  std::size_t both = 0;
  std::size_t either = 0;
};

Overlap OverlapAt(std::span<const Outcome> outcomes, double boundary) {
  Overlap overlap;
  for (const Outcome& outcome : outcomes) {
    const bool predicted = static_cast<double>(outcome.probability) >= boundary;
    overlap.both += predicted && outcome.edited ? 1 : 0;
    overlap.either += predicted || outcome.edited ? 1 : 0;
  }
  return overlap;
}

double Ratio(Overlap overlap) {
  if (overlap.either == 0) return 1.0;
  return static_cast<double>(overlap.both) / static_cast<double>(overlap.either);
}

struct EditPair {
  double expected = 0.0;
  double actual = 0.0;
};

std::vector<EditPair> EditsOfSegments(const Outcomes& outcomes) {
  std::vector<EditPair> pairs(outcomes.segments());
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    for (const Outcome& outcome : outcomes.Segment(i)) {
      pairs[i].expected += static_cast<double>(outcome.probability);
      pairs[i].actual += outcome.edited ? 1.0 : 0.0;
    }
  }
  return pairs;
}

EditPair Mean(std::span<const EditPair> pairs) {
  EditPair mean;
  for (const EditPair& pair : pairs) {
    mean.expected += pair.expected / static_cast<double>(pairs.size());
    mean.actual += pair.actual / static_cast<double>(pairs.size());
  }
  return mean;
}

std::optional<double> Correlation(std::span<const EditPair> pairs, EditPair mean) {
  double covariance = 0.0;
  double expected_variance = 0.0;
  double actual_variance = 0.0;
  for (const EditPair& pair : pairs) {
    const double expected = pair.expected - mean.expected;
    const double actual = pair.actual - mean.actual;
    covariance += expected * actual;
    expected_variance += expected * expected;
    actual_variance += actual * actual;
  }
  // If all values are equal, rounding leaves a little variance.
  constexpr double kNone = 1.0e-18;
  const auto count = static_cast<double>(pairs.size());
  if (!(expected_variance > kNone * count) || !(actual_variance > kNone * count)) return {};
  return covariance / std::sqrt(expected_variance * actual_variance);
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

double CrossEntropy(double probability, bool edited) {
  const double p = std::clamp(probability, kProbabilityFloor, 1.0 - kProbabilityFloor);
  return edited ? -std::log(p) : -std::log1p(-p);
}

Loss MeanCrossEntropy(const Outcomes& outcomes) {
  if (outcomes.values.empty()) return {};
  double sum = 0.0;
  for (const Outcome& outcome : outcomes.values) {
    sum += CrossEntropy(static_cast<double>(outcome.probability), outcome.edited);
  }
  return {sum / static_cast<double>(outcomes.outputs),
          sum / static_cast<double>(outcomes.values.size())};
}

double IouAt(const Outcomes& outcomes, double boundary) {
  if (outcomes.segments() == 0) return 0.0;
  return Ratio(OverlapAt(outcomes.values, boundary));
}

BoundaryIou BestIou(const Outcomes& outcomes) {
  BoundaryIou best{kBoundaryStep, IouAt(outcomes, kBoundaryStep)};
  for (int i = 2; i <= 99; ++i) {
    const double boundary = i * kBoundaryStep;
    const double iou = IouAt(outcomes, boundary);
    if (iou > best.iou) best = {boundary, iou};
  }
  return best;
}

std::optional<double> SegmentMeanIou(const Outcomes& outcomes, double boundary) {
  double sum = 0.0;
  std::size_t count = 0;
  for (std::size_t i = 0; i < outcomes.segments(); ++i) {
    const Overlap overlap = OverlapAt(outcomes.Segment(i), boundary);
    if (overlap.either == 0) continue;
    sum += Ratio(overlap);
    ++count;
  }
  if (count == 0) return {};
  return sum / static_cast<double>(count);
}

Calibration Calibrate(const Outcomes& outcomes, int bins) {
  Calibration calibration;
  calibration.bins.resize(static_cast<std::size_t>(bins));
  for (int i = 0; i < bins; ++i) {
    ReliabilityBin& bin = calibration.bins[static_cast<std::size_t>(i)];
    bin.low = static_cast<double>(i) / bins;
    bin.high = static_cast<double>(i + 1) / bins;
  }
  for (const Outcome& outcome : outcomes.values) {
    const double probability = static_cast<double>(outcome.probability);
    ReliabilityBin& bin = calibration.bins[static_cast<std::size_t>(
        std::min(static_cast<int>(probability * bins), bins - 1))];
    ++bin.outputs;
    bin.mean_probability += probability;
    bin.edited_share += outcome.edited ? 1.0 : 0.0;
  }
  for (ReliabilityBin& bin : calibration.bins) {
    if (bin.outputs == 0) continue;
    const auto count = static_cast<double>(bin.outputs);
    calibration.error += std::abs(bin.mean_probability - bin.edited_share) /
                         static_cast<double>(outcomes.values.size());
    bin.mean_probability /= count;
    bin.edited_share /= count;
  }
  return calibration;
}

EditCounts CompareEditCounts(const Outcomes& outcomes, std::size_t bins) {
  std::vector<EditPair> pairs = EditsOfSegments(outcomes);
  EditCounts counts;
  if (pairs.empty()) return counts;
  const EditPair mean = Mean(pairs);
  counts.mean_expected = mean.expected;
  counts.mean_true = mean.actual;
  counts.correlation = Correlation(pairs, mean);
  std::stable_sort(pairs.begin(), pairs.end(),
                   [](const EditPair& a, const EditPair& b) { return a.expected < b.expected; });
  bins = std::min(bins, pairs.size());
  for (std::size_t i = 0; i < bins; ++i) {
    const std::size_t begin = i * pairs.size() / bins;
    const std::size_t end = (i + 1) * pairs.size() / bins;
    const EditPair of_bin = Mean(std::span(pairs).subspan(begin, end - begin));
    counts.bins.push_back({end - begin, of_bin.expected, of_bin.actual});
  }
  return counts;
}

}  // namespace conav::nhpm
