#include "study/experiment/tradeoff.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "common/runtime/random.h"
#include "common/runtime/result.h"

namespace conav::planner {
namespace {

constexpr double kCosts[]{0.0, 0.125, 0.25, 0.5, 1.0, 1.5, 2.0, 3.0, 4.0, 6.0, 50.0};
constexpr double kProbabilities[]{0.02, 0.05, 0.1, 0.2, 0.4, 0.8};
constexpr double kEveryMoves[]{1.0, 2.0, 3.0, 5.0, 8.0, 12.0, 20.0};
constexpr double kThresholds[]{0.1, 0.25, 0.5, 1.0, 1.5, 2.0, 3.0, 4.0};

void Add(TradeoffSweep& sweep, const SearchConfig& search, const std::string& policy,
         std::optional<double> parameter) {
  SearchVariant variant;
  variant.name = policy;
  variant.config = search;
  if (parameter) variant.name = fmt::format("{} {:g}", policy, *parameter);
  if (policy == "greedy") {
    variant.method = MethodKind::kGreedy;
  } else {
    variant.communication.policy = policy;
  }
  const double value = parameter.value_or(0.0);
  if (policy == "search") variant.config.options.reward.communication_cost = value;
  if (policy == "random") variant.communication.probability = value;
  if (policy == "every") variant.communication.every_moves = static_cast<int>(std::lround(value));
  if (policy == "threshold") variant.communication.threshold_cells = value;
  sweep.points.push_back({policy, parameter});
  sweep.experiment.variants.push_back(std::move(variant));
}

}  // namespace

TradeoffSweep MakeTradeoffSweep(const SearchConfig& search, SearchExperiment experiment,
                                double turn_cost) {
  TradeoffSweep sweep;
  sweep.experiment = std::move(experiment);
  sweep.experiment.variants.clear();
  for (const double cost : kCosts) Add(sweep, search, "search", cost);
  for (const double probability : kProbabilities) Add(sweep, search, "random", probability);
  for (const double moves : kEveryMoves) Add(sweep, search, "every", moves);
  for (const double cells : kThresholds) Add(sweep, search, "threshold", cells);
  for (const char* policy : {"when_blocked", "never", "greedy"}) {
    Add(sweep, search, policy, std::nullopt);
  }
  for (SearchVariant& variant : sweep.experiment.variants) {
    variant.communication.turn_cost = turn_cost;
  }
  return sweep;
}

TradeoffCurve::TradeoffCurve(std::vector<TradeoffMeans> points) : points_(std::move(points)) {
  DEMAND(!points_.empty());
  std::sort(points_.begin(), points_.end(), [](const TradeoffMeans& a, const TradeoffMeans& b) {
    return std::pair(a.snapshots, a.effort) < std::pair(b.snapshots, b.effort);
  });
}

std::optional<double> TradeoffCurve::EffortAt(double snapshots) const {
  if (snapshots < points_.front().snapshots) return std::nullopt;
  double least = points_.front().effort;
  for (std::size_t i = 1; i < points_.size(); ++i) {
    const TradeoffMeans& from = points_[i - 1];
    const TradeoffMeans& to = points_[i];
    if (snapshots < to.snapshots) {
      const double share = (snapshots - from.snapshots) / (to.snapshots - from.snapshots);
      return std::min(least, from.effort + share * (to.effort - from.effort));
    }
    least = std::min(least, to.effort);
  }
  return least;
}

std::optional<double> TradeoffCurve::SnapshotsAt(double effort) const {
  if (points_.front().effort <= effort) return points_.front().snapshots;
  for (std::size_t i = 1; i < points_.size(); ++i) {
    const TradeoffMeans& from = points_[i - 1];
    const TradeoffMeans& to = points_[i];
    if (to.effort > effort) continue;
    const double share = (from.effort - effort) / (from.effort - to.effort);
    return from.snapshots + share * (to.snapshots - from.snapshots);
  }
  return std::nullopt;
}

namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();

double MovesOf(const EpisodeResult& result) {
  return result.all_goals ? result.moves : EpisodeOptions().action_limit;
}

double StepsOf(const EpisodeResult& result) {
  return EstimatedLowLevelSteps(MovesOf(result), result.all_goals ? result.turning_rad : 0.0);
}

/// Episodes of one variant with one kind of operator, by maze.
using Episodes = std::span<const ExperimentEpisode>;

TradeoffRow Describe(Episodes cell) {
  TradeoffRow row;
  row.point = cell.front().variant;
  row.person = cell.front().person;
  row.episodes = static_cast<int>(cell.size());
  for (const ExperimentEpisode& episode : cell) row.all_goals += episode.result.all_goals ? 1 : 0;
  row.snapshots = FigureOf(cell, &EpisodeResult::snapshots);
  row.moves = FigureOf(cell, MovesOf);
  row.steps = FigureOf(cell, StepsOf);
  row.guidance = FigureOf(cell, &EpisodeResult::guidance);
  row.mapping_accuracy = FigureOf(cell, &EpisodeResult::mapping_accuracy);
  return row;
}

/// Means over the mazes in `drawn`, some of them several times.
TradeoffMeans MeansOf(Episodes cell, const std::vector<std::size_t>& drawn, Effort effort) {
  const auto effort_of = effort == Effort::kSteps ? StepsOf : MovesOf;
  TradeoffMeans means;
  for (const std::size_t maze : drawn) {
    means.snapshots += cell[maze].result.snapshots;
    means.effort += effort_of(cell[maze].result);
  }
  const auto count = static_cast<double>(drawn.size());
  return {means.snapshots / count, means.effort / count};
}

struct Differences {
  double effort = 0.0;
  double snapshots = 0.0;
};

Differences Compare(const TradeoffCurve& curve, const TradeoffMeans& other) {
  const auto effort = curve.EffortAt(other.snapshots);
  const auto snapshots = curve.SnapshotsAt(other.effort);
  return {effort ? *effort - other.effort : kNever,
          snapshots ? *snapshots - other.snapshots : kNever};
}

TradeoffVerdict VerdictOf(const TradeoffComparison& comparison) {
  const Interval& effort = comparison.effort_at_equal_snapshots.interval;
  const Interval& snapshots = comparison.snapshots_at_equal_effort.interval;
  if (effort.high < 0.0 || snapshots.high < 0.0) return TradeoffVerdict::kBetter;
  if (std::isinf(comparison.effort_at_equal_snapshots.value)) return TradeoffVerdict::kBeyond;
  if (effort.low > 0.0 && snapshots.low > 0.0) return TradeoffVerdict::kWorse;
  return TradeoffVerdict::kAlike;
}

/// All points with one kind of operator.
class Comparer {
 public:
  Comparer(const TradeoffSweep& sweep, std::vector<Episodes> cells)
      : sweep_(sweep), cells_(std::move(cells)), draws_(cells_.size()) {
    std::vector<std::size_t> every_maze(cells_.front().size());
    for (std::size_t i = 0; i < every_maze.size(); ++i) every_maze[i] = i;
    of_all_ = CompareAll(every_maze);
  }

  /// Draws as many mazes as there are, with replacement.
  void Draw(Random& random) {
    std::vector<std::size_t> drawn(cells_.front().size());
    const auto last = static_cast<std::int64_t>(drawn.size()) - 1;
    for (std::size_t& maze : drawn) maze = static_cast<std::size_t>(random.Uniform(0, last));
    const std::vector<Differences> differences = CompareAll(drawn);
    for (std::size_t i = 0; i < differences.size(); ++i) draws_[i].push_back(differences[i]);
  }

  TradeoffComparison ComparisonOf(std::size_t point) const {
    std::vector<double> efforts, snapshots;
    for (const Differences& draw : draws_[point]) {
      efforts.push_back(draw.effort);
      snapshots.push_back(draw.snapshots);
    }
    TradeoffComparison comparison;
    comparison.effort_at_equal_snapshots = {of_all_[point].effort,
                                            PercentilesOf(std::move(efforts))};
    comparison.snapshots_at_equal_effort = {of_all_[point].snapshots,
                                            PercentilesOf(std::move(snapshots))};
    comparison.verdict = VerdictOf(comparison);
    return comparison;
  }

 private:
  std::vector<Differences> CompareAll(const std::vector<std::size_t>& drawn) const {
    std::vector<TradeoffMeans> means, of_search;
    for (std::size_t i = 0; i < cells_.size(); ++i) {
      means.push_back(MeansOf(cells_[i], drawn, sweep_.effort));
      if (sweep_.points[i].policy == "search") of_search.push_back(means.back());
    }
    const TradeoffCurve curve(std::move(of_search));
    std::vector<Differences> differences;
    for (const TradeoffMeans& other : means) differences.push_back(Compare(curve, other));
    return differences;
  }

  const TradeoffSweep& sweep_;
  std::vector<Episodes> cells_;  // by point
  std::vector<Differences> of_all_;
  std::vector<std::vector<Differences>> draws_;  // by point
};

}  // namespace

std::vector<TradeoffRow> AnalyseTradeoff(const TradeoffSweep& sweep,
                                         const std::vector<ExperimentEpisode>& episodes,
                                         int draws) {
  const auto seeds = static_cast<std::size_t>(sweep.experiment.seeds);
  const std::size_t people = sweep.experiment.operators.size();
  DEMAND(episodes.size() == sweep.points.size() * people * seeds, episodes.size(), seeds);
  std::vector<TradeoffRow> rows;
  for (std::size_t i = 0; i < episodes.size(); i += seeds) {
    rows.push_back(Describe(std::span(episodes).subspan(i, seeds)));
  }
  for (std::size_t person = 0; person < people; ++person) {
    std::vector<Episodes> cells;
    for (std::size_t point = 0; point < sweep.points.size(); ++point) {
      cells.push_back(std::span(episodes).subspan((point * people + person) * seeds, seeds));
    }
    Comparer comparer(sweep, std::move(cells));
    Random random(kBootstrapSeed);
    for (int draw = 0; draw < draws; ++draw) comparer.Draw(random);
    for (std::size_t point = 0; point < sweep.points.size(); ++point) {
      if (sweep.points[point].policy == "search") continue;
      rows[point * people + person].search_less_this = comparer.ComparisonOf(point);
    }
  }
  return rows;
}

std::vector<PolicyVerdict> JudgePolicies(const TradeoffSweep& sweep,
                                         const std::vector<TradeoffRow>& rows) {
  std::vector<PolicyVerdict> verdicts;
  for (const TradeoffRow& row : rows) {
    if (!row.search_less_this) continue;
    const std::string& policy = sweep.points[row.point].policy;
    auto found = std::find_if(verdicts.begin(), verdicts.end(), [&](const PolicyVerdict& v) {
      return v.policy == policy && v.person == row.person;
    });
    if (found == verdicts.end()) found = verdicts.insert(found, {policy, row.person});
    ++found->points;
    found->better += row.search_less_this->verdict == TradeoffVerdict::kBetter ? 1 : 0;
    found->worse += row.search_less_this->verdict == TradeoffVerdict::kWorse ? 1 : 0;
    found->beyond += row.search_less_this->verdict == TradeoffVerdict::kBeyond ? 1 : 0;
  }
  return verdicts;
}

}  // namespace conav::planner
