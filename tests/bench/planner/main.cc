// conav-bench-planner: what a decision costs, next to the same search written plainly.
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <numeric>

#include "bench/planner/plain_search.h"
#include "bench/planner/regions.h"
#include "bench/planner/sides.h"
#include "bench/support/bench_program.h"
#include "nhpm/model/load_model.h"
#include "nhpm/model/perception_network.h"
#include "planner/methods/ig_mcts_method.h"
#include "planner/perception/cached_model.h"
#include "planner/search/ig_mcts.h"
#include "study/experiment/search_experiment.h"

namespace conav::bench {
namespace {

using planner::SearchOptions;
using planner::Situation;

constexpr int kHeadings = 8;
constexpr std::array kBudgetsMs{1.0, 5.0, 20.0};

struct Options {
  int episodes = 20;
  std::vector<int> sides;
  int decisions = 60;
  std::string weights;
};

nhpm::NetworkModel ReadModel(const Options& options) {
  auto model = nhpm::ReadWeightsFile(nhpm::WeightsOrShipped(options.weights));
  if (!model) throw StartupError(model.error().text);
  return *std::move(model);
}

/// What one way to search cost, over the decisions of all episodes.
struct Decisions {
  std::vector<double> ms;  // processor time
  std::uint64_t evaluations = 0;
  std::uint64_t remembered = 0;  // within a decision, or from one to the next

  /// "<prefix>_p50_ms" and so on.
  void AddTo(const std::string& prefix, Rounds& rounds) const {
    std::vector<double> sorted = ms;
    std::sort(sorted.begin(), sorted.end());
    for (const int percent : {50, 95, 99}) {
      const double place = 0.01 * percent * static_cast<double>(sorted.size() - 1);
      rounds.Add(
          {{fmt::format("{}_p{}_ms", prefix, percent), sorted[static_cast<std::size_t>(place)]}});
    }
    const auto count = static_cast<double>(ms.size());
    rounds.Add({{prefix + "_mean_ms", std::accumulate(ms.begin(), ms.end(), 0.0) / count},
                {prefix + "_evaluations", static_cast<double>(evaluations) / count},
                {prefix + "_remembered", static_cast<double>(remembered) / count}});
  }
};

/// The processor time of the calling thread as a clock: what others do on the machine does not count.
class ThreadClock final : public Clock {
 public:
  TimePoint Now() const override {
    return TimePoint() + std::chrono::duration_cast<std::chrono::nanoseconds>(
                             std::chrono::duration<double>(ThreadSeconds()));
  }
};

SearchOptions Iterations100() {
  SearchOptions options;
  options.iterations = 100;
  return options;
}

class Benchmark {
 public:
  explicit Benchmark(const Options& options) : options_(options), model_(ReadModel(options)) {
    network_ = std::make_shared<nhpm::PerceptionNetwork>(model_);
    for (int i = 0; i < options.episodes; ++i) {
      sim::WorldOptions world;
      world.seed = static_cast<std::uint64_t>(i) + 1;
      worlds_.push_back(sim::MakeWorldSpec(world).value());
    }
  }

  /// Whole decisions of the method ig-mcts, as a planner makes them, in its episodes.
  Decisions Play(const SearchOptions& search) {
    Decisions decisions;
    for (std::size_t i = 0; i < worlds_.size(); ++i) {
      const auto cache = MakeCache();
      planner::IgMctsMethod method({.options = search}, i + 1, cache, clock_);
      const auto result = planner::RunEpisode(worlds_[i], method, person_, i + 1, {},
                                              [&](const Situation& s) { Keep(s); });
      decisions.ms.insert(decisions.ms.end(), result.decision_ms.begin(), result.decision_ms.end());
      decisions.evaluations += cache->counts().asked;
      decisions.remembered += cache->counts().cached + result.perception_cached;
    }
    keeps_ = false;
    return decisions;
  }

  /// By how much the decisions in every fourth situation of the episodes overran this budget of time,
  /// in milliseconds of the processor time of the thread that makes them.
  std::vector<double> Overruns(double budget_ms) {
    SearchOptions search;
    search.iterations = 1'000'000;
    search.time_budget_ms = budget_ms;
    const auto cache = MakeCache();
    const ThreadClock clock;
    Views views;
    std::vector<double> overruns_ms;
    for (std::size_t i = 0; i < situations_.size(); i += 4) {
      const auto problem = ProblemOf(situations_[i], views);
      Random random(i);
      const auto start = clock.Now();
      kept_ += planner::ParallelSearch(search, *cache)
                   .Decide(*problem.get(), random, {.clock = &clock})
                   .value()
                   .iterations;
      const std::chrono::duration<double, std::milli> taken = clock.Now() - start;
      overruns_ms.push_back(taken.count() - budget_ms);
    }
    return overruns_ms;
  }

  /// Wall time of a decision with four trees in all situations, on so many threads; the choices are
  /// added to `chosen`.
  double FourTrees(int threads, std::vector<int>& chosen) {
    SearchOptions search;
    search.trees = 4;
    search.tree_threads = threads;
    auto cache = MakeCache();
    Views views;
    std::vector<double> ms;
    for (std::size_t i = 0; i < situations_.size(); ++i) {
      if (situations_[i].state.cell_moves == 0) cache = MakeCache();  // another episode
      const auto problem = ProblemOf(situations_[i], views);
      Random random(i);
      const auto decide = [&] {
        planner::ParallelSearch search_of_all(search, *cache);
        chosen.push_back(search_of_all.Decide(*problem.get(), random)->chosen);
      };
      ms.push_back(1e3 * WallSecondsOf(decide));
    }
    return Median(ms);
  }

  /// The same problems by both, one after the other: nothing is withheld, and our cache is kept
  /// along an episode. Returns (plain, ours) milliseconds of all; throws when they decide
  /// differently.
  std::pair<double, double> Compare(const SearchOptions& search) {
    double plain_s = 0.0, ours_s = 0.0;
    const BeliefGrid& map = situations_.front().belief.wall_probability;
    PlainSearch plain(search, model_, map.rows(), map.columns());
    auto cache = MakeCache();
    Views views;
    for (std::size_t i = 0; i < situations_.size(); ++i) {
      const Situation& situation = situations_[i];
      if (situation.state.cell_moves == 0) cache = MakeCache();  // another episode
      Random plain_random(i), random(i);
      int plainly = 0;
      int decided = 0;
      plain_s += ThreadSecondsOf([&] {
        Views none;
        plainly = plain.Decide(*ProblemOf(situation, none).get(), plain_random);
      });
      ours_s += ThreadSecondsOf([&] {
        const auto problem = ProblemOf(situation, views);
        planner::ParallelSearch ours(search, *cache);
        decided = ours.Decide(*problem.get(), random).value().chosen;
      });
      if (decided != plainly) {
        throw std::runtime_error(
            fmt::format("situation {}: plain search chose {}, ours {}", i, plainly, decided));
      }
    }
    return {1e3 * plain_s, 1e3 * ours_s};
  }

  /// Moves per second of rollouts where no views are offered.
  double RolloutSteps() {
    Views views;
    const auto holder = ProblemOf(situations_.front(), views);
    planner::SearchProblem problem = *holder.get();
    for (planner::VertexId vertex = 0; vertex < problem.graph.vertex_count(); ++vertex) {
      for (const double heading_rad : problem.graph.HeadingsAt(vertex)) {
        problem.sent_views.push_back({problem.graph.CellOf(vertex), heading_rad});
      }
    }
    const SearchOptions search;
    const auto model = MakeCache();
    Random random(1);
    planner::OfferedActions offered(problem);
    planner::ViewInformation information(problem, offered, *model);
    planner::PathState path(problem, 2 * search.rollout_depth);
    planner::Rollout rollout(search, path, offered, information, random);
    const double seconds = ThreadSecondsOf([&] {
      for (int i = 0; i < 20'000; ++i) kept_ += rollout.Run(path).value();
    });
    return static_cast<double>(rollout.moves()) / seconds;
  }

  std::size_t situations() const { return situations_.size(); }

 private:
  using Views = std::shared_ptr<const planner::GridViews>;

  /// `views` are kept from one situation to the next.
  static planner::SituationProblem ProblemOf(const Situation& situation, Views& views) {
    views = planner::ViewsFor(situation, kHeadings, std::move(views));
    return {situation,
            std::make_shared<const BeliefGrid>(situation.belief.wall_probability),
            {},
            views};
  }
  std::shared_ptr<planner::CachedPerceptionModel> MakeCache() const {
    return std::make_shared<planner::CachedPerceptionModel>(network_);
  }
  void Keep(const Situation& situation) {
    if (keeps_) situations_.push_back(situation);
  }

  Options options_;
  nhpm::NetworkModel model_;
  std::shared_ptr<nhpm::PerceptionNetwork> network_;
  std::vector<sim::WorldSpec> worlds_;
  const operators::SyntheticOperatorParameters person_;
  std::vector<Situation> situations_;  // of the first Play()
  bool keeps_ = true;
  SteadyClock clock_;
  double kept_ = 0.0;  // so that nothing is optimised away
};

/// By how much each budget was overrun, by round and decision.
using Overruns = std::vector<std::vector<double>>;

/// Of all decisions of all rounds: the machine's hiccups are in it, too.
double LongestOverrun(const Overruns& rounds) {
  double longest = 0.0;
  for (const auto& round : rounds) longest = std::max(longest, std::ranges::max(round));
  return longest;
}

/// The worst decision, each by the median of its rounds: what comes back is the search's doing.
double WorstOverrun(const Overruns& rounds) {
  double worst = 0.0;
  for (std::size_t i = 0; i < rounds.front().size(); ++i) {
    std::vector<double> of_decision;
    for (const auto& round : rounds) of_decision.push_back(round[i]);
    worst = std::max(worst, Median(of_decision));
  }
  return worst;
}

struct Measured {
  Rounds rounds;
  std::array<Overruns, kBudgetsMs.size()> overruns;  // by budget
};

/// Throws when the number of threads changes a choice.
void MeasureTrees(Benchmark& benchmark, Rounds& rounds) {
  std::vector<int> by_one;
  for (const int threads : {1, 2, 4}) {
    std::vector<int> chosen;
    rounds.Add(
        {{fmt::format("trees4_threads{}_p50_ms", threads), benchmark.FourTrees(threads, chosen)}});
    if (threads == 1) by_one = chosen;
    if (chosen != by_one) {
      throw std::runtime_error("four trees choose differently on more threads");
    }
  }
}

void MeasureRound(Benchmark& benchmark, Measured& measured) {
  Rounds& rounds = measured.rounds;
  benchmark.Play(Iterations100()).AddTo("iterations100", rounds);
  benchmark.Play({}).AddTo("default", rounds);
  const auto [plain_ms, ours_ms] = benchmark.Compare(Iterations100());
  rounds.Add(
      {{"rollout_steps_per_s", benchmark.RolloutSteps()}, {"plain_ratio", plain_ms / ours_ms}});
  MeasureTrees(benchmark, rounds);
  for (std::size_t budget = 0; budget < kBudgetsMs.size(); ++budget) {
    measured.overruns[budget].push_back(benchmark.Overruns(kBudgetsMs[budget]));
  }
}

Json Metrics(const Measured& measured) {
  Json metrics;
  for (const char* name :
       {"iterations100_p50_ms", "iterations100_p95_ms", "default_p50_ms", "default_p95_ms",
        "rollout_steps_per_s", "plain_ratio", "region_build_ms", "region_update_p50_ms",
        "region_update_p95_ms", "region1000_build_ms", "region1000_update_p50_ms",
        "region1000_update_p95_ms"}) {
    metrics[name] = measured.rounds.Median(name);
  }
  metrics["robots_per_core_5hz"] = 200.0 / measured.rounds.Median("default_mean_ms");
  for (const int threads : {1, 2, 4}) {
    const std::string name = fmt::format("trees4_threads{}_p50_ms", threads);
    metrics[name] = measured.rounds.Median(name);
  }
  double worst = 0.0, longest = 0.0;
  for (const Overruns& overruns : measured.overruns) {
    worst = std::max(worst, WorstOverrun(overruns));
    longest = std::max(longest, LongestOverrun(overruns));
  }
  metrics["time_budget_overrun_ms_max"] = worst;
  metrics["time_budget_overrun_ms_longest"] = longest;
  return metrics;
}

void PrintRow(const Rounds& rounds, const char* name, const std::string& prefix) {
  const auto value = [&](const char* rest) { return rounds.Median(prefix + rest); };
  const double mean_ms = value("_mean_ms");
  fmt::print("{:<22} {:6.2f} {:6.2f} {:6.2f} {:8.1f} {:10.1f} {:12.0f} {:10.0f}\n", name,
             value("_p50_ms"), value("_p95_ms"), value("_p99_ms"), value("_evaluations"),
             value("_remembered"), 1e3 / mean_ms, 200.0 / mean_ms);
}

void PrintTable(const Measured& measured, std::size_t situations) {
  const Rounds& rounds = measured.rounds;
  fmt::print("{:<22} {:>6} {:>6} {:>6} {:>8} {:>10} {:>12} {:>10}\n", "a decision, ms", "p50",
             "p95", "p99", "network", "remembered", "decisions/s", "robots");
  fmt::print("{:<22} {:>6} {:>6} {:>6} {:>8} {:>10} {:>12} {:>10}\n", "", "", "", "", "passes",
             "look-ups", "and core", "at 5 Hz");
  PrintRow(rounds, "100 iterations", "iterations100");
  PrintRow(rounds, "default preset", "default");
  fmt::print(
      "\nthe same {} decisions (100 iterations) by the search written plainly: "
      "{:.1f} x the time, the same choices\n",
      situations, rounds.Median("plain_ratio"));
  const double steps_per_s = rounds.Median("rollout_steps_per_s");
  fmt::print("rollouts without pictures: {:.1f} M moves/s, {:.1f} ns a move\n", 1e-6 * steps_per_s,
             1e9 / steps_per_s);
  fmt::print(
      "four trees of the default preset for one robot, the same choices on all, wall time p50: "
      "{:.2f} ms on 1 thread,\n{:.2f} ms on 2, {:.2f} ms on 4\n",
      rounds.Median("trees4_threads1_p50_ms"), rounds.Median("trees4_threads2_p50_ms"),
      rounds.Median("trees4_threads4_p50_ms"));
  fmt::print(
      "budgets of time, overrun of the worst decision in processor time (longest of a round):");
  for (std::size_t budget = 0; budget < kBudgetsMs.size(); ++budget) {
    fmt::print("{} {:.3f} ({:.3f}) ms of {:g} ms", budget == 0 ? "" : ";",
               WorstOverrun(measured.overruns[budget]), LongestOverrun(measured.overruns[budget]),
               kBudgetsMs[budget]);
  }
  fmt::print("\n");
}

void RunSides(const BenchProgram& program, const Options& options) {
  constexpr int kMazes = 5;
  fmt::print(
      "{}; one thread, processor time, medians of {} rounds; the first {} decisions\n"
      "in {} mazes of each side with a simulated operator and the network inside the planner\n\n",
      Machine(), program.rounds(), options.decisions, kMazes);
  const Rounds rounds =
      MeasureSides(program, options.sides, kMazes, options.decisions, ReadModel(options));
  PrintSides(rounds, options.sides);
  program.Write({{"rounds", program.rounds()}, {"metrics", rounds.Medians()}});
}

void Run(const BenchProgram& program, const Options& options) {
  if (!options.sides.empty()) return RunSides(program, options);
  Benchmark benchmark(options);
  Measured measured;
  const RegionDrive usual(150, 1), large(125, 8);
  program.ForEachRound([&] {
    MeasureRound(benchmark, measured);
    AddRegionCosts(usual.Measure(), "region", measured.rounds);
    AddRegionCosts(large.Measure(), "region1000", measured.rounds);
  });
  fmt::print(
      "{}; one thread, processor time, medians of {} rounds; decisions of {} episodes in\n"
      "mazes of 13 x 13 with a simulated operator and the network inside the planner\n\n",
      Machine(), program.rounds(), options.episodes);
  PrintTable(measured, benchmark.situations());
  PrintRegionCosts(measured.rounds);
  program.Write({{"rounds", program.rounds()}, {"metrics", Metrics(measured)}});
}

}  // namespace
}  // namespace conav::bench

int main(int argc, char** argv) {
  using namespace conav::bench;
  BenchProgram program(
      "conav-bench-planner",
      "Cost of a decision of IG-MCTS with the network inside the planner: 100 iterations,\n"
      "the default preset, rollouts alone, and the same search written plainly\n"
      "(a whole pass of the network for each query, nothing remembered), which must decide alike.\n"
      "Metrics of --json: iterations100_p50_ms, iterations100_p95_ms, default_p50_ms, "
      "default_p95_ms,\n"
      "rollout_steps_per_s, plain_ratio (plain over ours), robots_per_core_5hz,\n"
      "trees4_threads1_p50_ms, trees4_threads2_p50_ms, trees4_threads4_p50_ms (four trees for one\n"
      "robot, wall time), time_budget_overrun_ms_max (budgets of 1, 5 and 20 ms, processor\n"
      "time; the worst decision, each by the median of its rounds), "
      "time_budget_overrun_ms_longest\n"
      "(of all rounds: the machine's hiccups are in it); region_build_ms, region_update_p50_ms,\n"
      "region_update_p95_ms (graph of a waterway's regions, 150 x 150 cells: built whole, and for\n"
      "each cell of a drive in which the robot saw more), region1000_... (1000 x 1000).\n"
      "With --sides instead: side<N>_p50_ms, side<N>_p95_ms, side<N>_longest_ms, side<N>_step_ms\n"
      "(of an episode), side<N>_whole_passes (of the network, in the episode with the most),\n"
      "side<N>_memory_mib; p95_ratio (of the largest side over 26).",
      5);
  Options options;
  program.AddNumber("--episodes", options.episodes, "Episodes whose decisions are made", 1, 1000);
  program.app()
      .add_option("--sides", options.sides,
                  "Mazes of these sides instead, in cells: 13,26,50,100,200")
      ->delimiter(',')
      ->check(conav::Between(13, 501));
  program.AddNumber("--decisions", options.decisions, "Of each maze with --sides", 1, 100'000);
  program.app().add_option("--weights", options.weights,
                           "Of the network (the ones that come with conav)");
  return program.Run(argc, argv, [&] { Run(program, options); });
}
