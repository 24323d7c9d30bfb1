#pragma once

#include <optional>
#include <string>
#include <vector>

#include "study/experiment/search_experiment.h"

namespace conav::planner {

/// The measure against which pictures are weighed.
enum class Effort { kSteps, kMoves };  // EstimatedLowLevelSteps, or cells entered
constexpr const char* Name(Effort effort) { return effort == Effort::kSteps ? "steps" : "moves"; }

/// What one variant of a trade-off sweep is: a policy that decides on pictures, and its parameter.
struct TradeoffPoint {
  std::string policy;               // of kCommunicationPolicies, or "greedy"
  std::optional<double> parameter;  // search: RewardOptions::communication_cost
};

/// Pictures against effort: IG-MCTS over costs of a picture, and every other communication policy
/// within the same planner over its parameter, in the same mazes. Points of one policy lie side by
/// side, in the order of their parameter.
struct TradeoffSweep {
  std::vector<TradeoffPoint> points;  // by variant
  Effort effort = Effort::kSteps;
  SearchExperiment experiment;
};

/// The sweep of all policies, and the greedy robot; all search with `search`. Mazes and
/// operators are those of `experiment`, whose variants are not looked at.
/// `turn_cost`: CommunicationConfig::turn_cost of the other policies.
TradeoffSweep MakeTradeoffSweep(const SearchConfig& search, SearchExperiment experiment,
                                double turn_cost = 0.0);

/// What an episode takes on average.
struct TradeoffMeans {
  double snapshots = 0.0;
  double effort = 0.0;  // steps or moves
};

/// Straight lines between the points of a sweep, from the fewest pictures to the most.
class TradeoffCurve {
 public:
  /// In any order; at least one.
  explicit TradeoffCurve(std::vector<TradeoffMeans> points);

  /// The least effort with at most `pictures`. Nothing below the end with the fewest.
  std::optional<double> EffortAt(double snapshots) const;
  /// The fewest pictures with which `effort` is enough. Nothing if the curve never gets there.
  std::optional<double> SnapshotsAt(double effort) const;

 private:
  std::vector<TradeoffMeans> points_;  // by pictures
};

/// How IG-MCTS does where another policy stands: its curve over costs of a picture less that
/// policy's point, so below 0 is better. Infinite where the curve does not get there. The interval
/// is the 95 % percentile bootstrap over mazes, the same ones for both (paired).
struct TradeoffDifference {
  double value = 0.0;
  Interval interval;
};

enum class TradeoffVerdict {
  kBetter,  // one of both intervals lies below 0
  kAlike,
  kWorse,   // both lie above
  kBeyond,  // not better, and the point has fewer pictures than the curve anywhere
};

struct TradeoffComparison {
  TradeoffDifference effort_at_equal_snapshots;
  TradeoffDifference snapshots_at_equal_effort;
  TradeoffVerdict verdict = TradeoffVerdict::kAlike;
};

/// One point of the sweep with one kind of SIMULATED operator.
struct TradeoffRow {
  std::size_t point = 0;
  std::size_t person = 0;
  int episodes = 0;
  int all_goals = 0;
  Figure snapshots;
  /// Cells entered, and EstimatedLowLevelSteps; an episode that did not reach all goals counts with
  /// its limit of actions, as moves.
  Figure moves;
  Figure steps;
  Figure guidance;
  Figure mapping_accuracy;
  std::optional<TradeoffComparison> search_less_this;  // not of points of the search

  const Figure& effort(Effort kind) const { return kind == Effort::kSteps ? steps : moves; }
};

/// In the order of the episodes, which are those of RunSearchExperiment(sweep.experiment). `draws`:
/// of each bootstrap.
std::vector<TradeoffRow> AnalyseTradeoff(const TradeoffSweep& sweep,
                                         const std::vector<ExperimentEpisode>& episodes,
                                         int draws = 2000);

/// All points of one policy with one kind of operator.
struct PolicyVerdict {
  std::string policy;
  std::size_t person = 0;
  int points = 0;
  int better = 0;  // where IG-MCTS is
  int worse = 0;
  int beyond = 0;
  bool dominated() const { return better == points; }
};

std::vector<PolicyVerdict> JudgePolicies(const TradeoffSweep& sweep,
                                         const std::vector<TradeoffRow>& rows);

/// A line per policy, parameter and operator, and below who is dominated; for people to read.
std::string TradeoffTable(const TradeoffSweep& sweep, const std::vector<TradeoffRow>& rows);

/// {experiment, operators: "simulated", ..., points: [...], policies: [...]}. An infinite
/// difference is null.
nlohmann::ordered_json TradeoffJson(const TradeoffSweep& sweep,
                                    const std::vector<TradeoffRow>& rows);

/// A line per episode: policy, parameter, kEpisodeColumns and estimated_steps.
std::string TradeoffCsv(const TradeoffSweep& sweep, const std::vector<ExperimentEpisode>& episodes);

/// An SVG document: a panel per kind of operator, pictures to the right (square-root scale, as most
/// policies differ where they are few), moves upwards, a line per policy through its points in the
/// order of their parameter, with both intervals of each.
std::string TradeoffPlot(const TradeoffSweep& sweep, const std::vector<TradeoffRow>& rows);

}  // namespace conav::planner
