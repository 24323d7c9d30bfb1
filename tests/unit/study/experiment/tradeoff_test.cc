#include "study/experiment/tradeoff.h"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

namespace conav::planner {
namespace {

constexpr int kSeeds = 20;

/// Mazes differ by up to 19 moves, policies by what they are given.
class MadeUp {
 public:
  MadeUp() {
    sweep.experiment.seeds = kSeeds;
    sweep.experiment.operators = {"careful"};
    sweep.effort = Effort::kMoves;
  }

  void Add(const std::string& policy, int snapshots, int moves, int failed = 0) {
    sweep.points.push_back({policy, 1.0});
    SearchVariant variant;
    variant.name = policy;
    sweep.experiment.variants.push_back(variant);
    for (int seed = 0; seed < kSeeds; ++seed) {
      ExperimentEpisode episode;
      episode.variant = sweep.points.size() - 1;
      episode.seed = static_cast<std::uint64_t>(seed);
      episode.result.all_goals = seed >= failed;
      episode.result.snapshots = snapshots;
      episode.result.moves = moves + seed;
      episode.result.mapping_accuracy = 0.5;
      episodes.push_back(episode);
    }
  }

  std::vector<TradeoffRow> Analyse() const { return AnalyseTradeoff(sweep, episodes, 200); }
  TradeoffComparison Last() const { return Analyse().back().search_less_this.value(); }

  TradeoffSweep sweep;
  std::vector<ExperimentEpisode> episodes;
};

MadeUp WithSearch() {
  MadeUp made;
  made.Add("search", 2, 40);
  made.Add("search", 4, 30);
  return made;
}

TEST_CASE("the curve is straight between its points, and gives what it has or nothing beyond them",
          "[planner][experiment]") {
  // Few pictures cost moves; more than four help no more.
  const TradeoffCurve falling({{8, 30}, {2, 40}, {4, 30}});
  // Here the least effort, and the fewest pictures, count where the curve comes back.
  const TradeoffCurve wavy({{1, 40}, {3, 20}, {5, 30}, {7, 10}});
  const TradeoffCurve point({{2, 40}}), twice({{2, 40}, {2, 40}});
  struct Row {
    const TradeoffCurve& curve;
    double snapshots;
    std::optional<double> effort;
  };
  for (const Row& row :
       {Row{falling, 2, 40.0}, Row{falling, 3, 35.0}, Row{falling, 6, 30.0}, Row{falling, 1.9, {}},
        Row{falling, 100, 30.0}, Row{wavy, 4, 20.0}, Row{wavy, 6.5, 15.0}, Row{wavy, 9, 10.0},
        Row{point, 2, 40.0}, Row{twice, 2, 40.0}}) {
    CAPTURE(row.snapshots);
    CHECK(row.curve.EffortAt(row.snapshots) == row.effort);
  }
  CHECK(falling.SnapshotsAt(37.5) == 2.5);
  CHECK(falling.SnapshotsAt(50) == 2.0);
  CHECK_FALSE(falling.SnapshotsAt(29.9));
  CHECK(wavy.SnapshotsAt(25) == 2.5);
  CHECK(wavy.SnapshotsAt(15) == 6.5);
  CHECK_FALSE(point.SnapshotsAt(39));
}

TEST_CASE("differences are paired: mazes that differ do not blur them", "[planner][experiment]") {
  struct Row {
    const char* policy;
    int moves;  // with 3 pictures; the curve has 35
    double effort, snapshots;
    TradeoffVerdict verdict;
  };
  for (const Row& row : {Row{"random", 37, -2.0, -0.4, TradeoffVerdict::kBetter},
                         Row{"threshold", 33, 2.0, 0.4, TradeoffVerdict::kWorse},
                         Row{"every", 35, 0.0, 0.0, TradeoffVerdict::kAlike}}) {
    CAPTURE(row.policy);
    MadeUp made = WithSearch();
    made.Add(row.policy, 3, row.moves);
    const TradeoffComparison comparison = made.Last();
    CHECK(comparison.effort_at_equal_snapshots.value == Approx(row.effort));
    CHECK(comparison.effort_at_equal_snapshots.interval.high == Approx(row.effort));
    CHECK(comparison.snapshots_at_equal_effort.value == Approx(row.snapshots));
    CHECK(comparison.verdict == row.verdict);
  }
}

TEST_CASE("steps count turning, moves do not", "[planner][experiment]") {
  MadeUp made = WithSearch();
  made.Add("every", 4, 30);
  for (ExperimentEpisode& episode : made.episodes) {
    if (episode.variant == 2) episode.result.turning_rad = 10.0;
  }
  CHECK(made.Last().verdict == TradeoffVerdict::kAlike);
  made.sweep.effort = Effort::kSteps;
  CHECK(made.Last().verdict == TradeoffVerdict::kBetter);
  CHECK(made.Last().effort_at_equal_snapshots.value == Approx(-EstimatedLowLevelSteps(0.0, 10.0)));
  CHECK(made.Analyse().back().steps.mean ==
        Approx(EstimatedLowLevelSteps(made.Analyse().back().moves.mean, 10.0)));
}

TEST_CASE("where the curve does not get there the difference is infinite and printed as such",
          "[planner][experiment]") {
  MadeUp made = WithSearch();
  made.Add("never", 0, 20);
  CHECK(std::isinf(made.Last().effort_at_equal_snapshots.value));
  CHECK(std::isinf(made.Last().snapshots_at_equal_effort.value));
  CHECK(made.Last().verdict == TradeoffVerdict::kBeyond);
  CHECK(JudgePolicies(made.sweep, made.Analyse()).back().beyond == 1);
  const auto json = TradeoffJson(made.sweep, made.Analyse());
  const auto& point = json.at("points").back().at("search_less_this");
  CHECK(point.at("effort_at_equal_pictures").at("value").is_null());
}

TEST_CASE("an episode that does not arrive counts with its limit of actions",
          "[planner][experiment]") {
  MadeUp made = WithSearch();
  made.Add("random", 3, 10, kSeeds);
  const TradeoffRow row = made.Analyse().back();
  CHECK(row.all_goals == 0);
  CHECK(row.moves.mean == EpisodeOptions().action_limit);
  CHECK(row.search_less_this->verdict == TradeoffVerdict::kBetter);
}

TEST_CASE("a policy is dominated when IG-MCTS is better at each of its points, then the bar is met",
          "[planner][experiment]") {
  MadeUp made = WithSearch();
  made.Add("random", 3, 37);
  made.Add("random", 4, 33);
  made.Add("never", 0, 20);  // sends no pictures: no point of the bar
  CHECK_THAT(TradeoffTable(made.sweep, made.Analyse()), Catch::Contains("2 of 2 points: met"));
  made.Add("threshold", 3, 37);
  made.Add("threshold", 3, 33);
  CHECK_THAT(TradeoffTable(made.sweep, made.Analyse()), Catch::Contains("3 of 4 points: MISSED"));
  const auto verdicts = JudgePolicies(made.sweep, made.Analyse());
  REQUIRE(verdicts.size() == 3);
  CHECK(verdicts[0].policy == "random");
  CHECK(verdicts[0].dominated());
  CHECK(verdicts[2].better == 1);
  CHECK(verdicts[2].worse == 1);
  CHECK_FALSE(verdicts[2].dominated());
}

TEST_CASE("a sweep has a point per cost and policy, each within the same search",
          "[planner][experiment]") {
  SearchExperiment experiment;
  experiment.variants.resize(3);
  experiment.seeds = 7;
  SearchConfig search;
  search.options.iterations = 77;
  const TradeoffSweep sweep = MakeTradeoffSweep(search, experiment);
  CHECK(sweep.experiment.seeds == 7);
  REQUIRE(sweep.points.size() == sweep.experiment.variants.size());
  std::set<std::string> policies;
  for (std::size_t i = 0; i < sweep.points.size(); ++i) {
    const SearchVariant& variant = sweep.experiment.variants[i];
    policies.insert(sweep.points[i].policy);
    CHECK(variant.config.options.iterations == 77);
    CHECK((variant.method == MethodKind::kGreedy ||
           variant.communication.policy == sweep.points[i].policy));
  }
  CHECK(policies == std::set<std::string>{"every", "greedy", "never", "random", "search",
                                          "threshold", "when_blocked"});
}

}  // namespace
}  // namespace conav::planner
