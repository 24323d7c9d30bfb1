// conav-bench-planner: what a decision costs, beside the same search written plainly.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>

#include "bench/planner/plain_search.h"
#include "bench/support/bench_program.h"
#include "bench/support/measure.h"
#include "nhpm/model/load_model.h"
#include "nhpm/model/perception_network.h"
#include "planner/methods/ig_mcts_method.h"
#include "planner/perception/cached_model.h"
#include "planner/search/rollout.h"
#include "study/experiment/search_experiment.h"

namespace conav::bench {
namespace {

using planner::SearchOptions;
using planner::Situation;

constexpr int kHeadings = 8;
constexpr std::array kBudgetsMs{1.0, 5.0, 20.0};

struct Options {
  int rounds = 5;
  int episodes = 20;
  std::string weights;
  std::string json;
};

/// What one way to search cost, over the decisions of all episodes.
struct Decisions {
  std::vector<double> ms;  // processor time
  std::uint64_t evaluations = 0;
  std::uint64_t remembered = 0;  // within a decision, or from one to the next

  double Percentile(double share) const {
    std::vector<double> sorted = ms;
    std::sort(sorted.begin(), sorted.end());
    return sorted.empty()
               ? 0.0
               : sorted[static_cast<std::size_t>(share * static_cast<double>(sorted.size() - 1))];
  }
  double Mean() const {
    double sum = 0.0;
    for (const double value : ms) sum += value;
    return ms.empty() ? 0.0 : sum / static_cast<double>(ms.size());
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
  explicit Benchmark(const Options& options) : options_(options) {
    const auto model = nhpm::ReadWeightsFile(nhpm::WeightsOrShipped(options.weights));
    if (!model) throw StartupError(model.error().text);
    model_ = *model;
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
    std::shared_ptr<const planner::GridViews> views;
    std::vector<double> overruns_ms;
    for (std::size_t i = 0; i < situations_.size(); i += 4) {
      views = planner::ViewsFor(situations_[i], kHeadings, std::move(views));
      const planner::SituationProblem problem(situations_[i],
                                              situations_[i].belief.wall_probability, {}, views);
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
    std::shared_ptr<const planner::GridViews> views;
    std::vector<double> ms;
    for (std::size_t i = 0; i < situations_.size(); ++i) {
      if (situations_[i].state.cell_moves == 0) cache = MakeCache();  // another episode
      views = planner::ViewsFor(situations_[i], kHeadings, std::move(views));
      const planner::SituationProblem problem(situations_[i],
                                              situations_[i].belief.wall_probability, {}, views);
      Random random(i);
      const auto start = clock_.Now();
      chosen.push_back(
          planner::ParallelSearch(search, *cache).Decide(*problem.get(), random)->chosen);
      ms.push_back(std::chrono::duration<double, std::milli>(clock_.Now() - start).count());
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
    std::shared_ptr<const planner::GridViews> views;
    for (std::size_t i = 0; i < situations_.size(); ++i) {
      const Situation& situation = situations_[i];
      if (situation.state.cell_moves == 0) cache = MakeCache();  // another episode
      Random plain_random(i), random(i);
      double start = ThreadSeconds();
      const planner::SituationProblem for_plain(situation, situation.belief.wall_probability, {},
                                                planner::ViewsFor(situation, kHeadings));
      const int plainly = plain.Decide(*for_plain.get(), plain_random);
      plain_s += ThreadSeconds() - start;
      start = ThreadSeconds();
      views = planner::ViewsFor(situation, kHeadings, std::move(views));
      const planner::SituationProblem problem(situation, situation.belief.wall_probability, {},
                                              views);
      const auto decided = planner::ParallelSearch(search, *cache).Decide(*problem.get(), random);
      ours_s += ThreadSeconds() - start;
      if (decided.value().chosen != plainly) {
        throw std::runtime_error(fmt::format("situation {}: plain search chose {}, ours {}", i,
                                             plainly, decided->chosen));
      }
    }
    return {1e3 * plain_s, 1e3 * ours_s};
  }

  /// Moves per second of rollouts where no views are offered.
  double RolloutSteps() {
    const Situation& situation = situations_.front();
    const planner::SituationProblem holder(situation, situation.belief.wall_probability, {},
                                           planner::ViewsFor(situation, kHeadings));
    planner::SearchProblem problem = *holder.get();
    for (planner::VertexId vertex = 0; vertex < problem.graph.vertex_count(); ++vertex) {
      for (const double heading_rad : problem.graph.HeadingsAt(vertex)) {
        problem.sent_views.push_back({problem.graph.CellOf(vertex), heading_rad});
      }
    }
    const SearchOptions search;
    const auto model = MakeCache();
    Random random(1);
    const planner::OfferedActions offered(problem);
    planner::ViewInformation information(problem, offered, *model);
    planner::PathState path(problem, 2 * search.rollout_depth);
    planner::Rollout rollout(search, path, offered, information, random);
    const double start = ThreadSeconds();
    for (int i = 0; i < 20'000; ++i) kept_ += rollout.Run(path).value();
    return static_cast<double>(rollout.moves()) / (ThreadSeconds() - start);
  }

  std::size_t situations() const { return situations_.size(); }

 private:
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

/// Values of the rounds.
struct Rounds {
  std::vector<Decisions> iterations100, chosen;
  std::vector<double> plain_ms, ours_ms, steps_per_s;
  std::vector<double> trees_ms_1, trees_ms_2, trees_ms_4;  // by threads
  using Overruns = std::vector<std::vector<double>>;       // by round and decision
  std::array<Overruns, kBudgetsMs.size()> overruns;        // by budget

  double Of(const std::vector<Decisions>& rounds, double share) const {
    std::vector<double> values;
    for (const Decisions& round : rounds) values.push_back(round.Percentile(share));
    return Median(values);
  }
};

void PrintRow(const Rounds& rounds, const char* name, const std::vector<Decisions>& of) {
  const Decisions& first = of.front();
  const auto count = static_cast<double>(first.ms.size());
  std::vector<double> means;
  for (const Decisions& round : of) means.push_back(round.Mean());
  const double mean = Median(means);
  fmt::print("{:<22} {:6.2f} {:6.2f} {:6.2f} {:8.1f} {:10.1f} {:12.0f} {:10.0f}\n", name,
             rounds.Of(of, 0.5), rounds.Of(of, 0.95), rounds.Of(of, 0.99),
             static_cast<double>(first.evaluations) / count,
             static_cast<double>(first.remembered) / count, 1e3 / mean, 200.0 / mean);
}

/// Of all decisions of all rounds: the machine's hiccups are in it, too.
double LongestOverrun(const Rounds::Overruns& rounds) {
  double longest = 0.0;
  for (const auto& round : rounds) {
    longest = std::max(longest, *std::max_element(round.begin(), round.end()));
  }
  return longest;
}

/// The worst decision, each by the median of its rounds: what comes back is the search's doing.
double WorstOverrun(const Rounds::Overruns& rounds) {
  double worst = 0.0;
  for (std::size_t i = 0; i < rounds.front().size(); ++i) {
    std::vector<double> of_decision;
    for (const auto& round : rounds) of_decision.push_back(round[i]);
    worst = std::max(worst, Median(of_decision));
  }
  return worst;
}

double WorstOverrun(const Rounds& rounds) {
  double worst = 0.0;
  for (const auto& of_budget : rounds.overruns) worst = std::max(worst, WorstOverrun(of_budget));
  return worst;
}

double LongestOverrun(const Rounds& rounds) {
  double longest = 0.0;
  for (const auto& of_budget : rounds.overruns) {
    longest = std::max(longest, LongestOverrun(of_budget));
  }
  return longest;
}

nlohmann::ordered_json Metrics(const Rounds& rounds) {
  std::vector<double> ratios, means;
  for (std::size_t i = 0; i < rounds.plain_ms.size(); ++i) {
    ratios.push_back(rounds.plain_ms[i] / rounds.ours_ms[i]);
    means.push_back(rounds.chosen[i].Mean());
  }
  return {{"iterations100_p50_ms", rounds.Of(rounds.iterations100, 0.5)},
          {"iterations100_p95_ms", rounds.Of(rounds.iterations100, 0.95)},
          {"default_p50_ms", rounds.Of(rounds.chosen, 0.5)},
          {"default_p95_ms", rounds.Of(rounds.chosen, 0.95)},
          {"rollout_steps_per_s", Median(rounds.steps_per_s)},
          {"plain_ratio", Median(ratios)},
          {"robots_per_core_5hz", 200.0 / Median(means)},
          {"trees4_threads1_p50_ms", Median(rounds.trees_ms_1)},
          {"trees4_threads2_p50_ms", Median(rounds.trees_ms_2)},
          {"trees4_threads4_p50_ms", Median(rounds.trees_ms_4)},
          {"time_budget_overrun_ms_max", WorstOverrun(rounds)},
          {"time_budget_overrun_ms_longest", LongestOverrun(rounds)}};
}

/// Throws when the number of threads changes a choice.
void MeasureTrees(Benchmark& benchmark, Rounds& rounds) {
  std::vector<int> by_one, by_two, by_four;
  rounds.trees_ms_1.push_back(benchmark.FourTrees(1, by_one));
  rounds.trees_ms_2.push_back(benchmark.FourTrees(2, by_two));
  rounds.trees_ms_4.push_back(benchmark.FourTrees(4, by_four));
  if (by_one != by_two || by_one != by_four) {
    throw std::runtime_error("four trees choose differently on more threads");
  }
}

void PrintOverruns(const Rounds& rounds) {
  fmt::print(
      "budgets of time, overrun of the worst decision in processor time (longest of a round):");
  for (std::size_t budget = 0; budget < kBudgetsMs.size(); ++budget) {
    fmt::print("{} {:.3f} ({:.3f}) ms of {:g} ms", budget == 0 ? "" : ";",
               WorstOverrun(rounds.overruns[budget]), LongestOverrun(rounds.overruns[budget]),
               kBudgetsMs[budget]);
  }
  fmt::print("\n");
}

void Run(const Options& options) {
  Benchmark benchmark(options);
  Rounds rounds;
  for (int i = 0; i < options.rounds; ++i) {
    ShowRound(i, options.rounds);
    rounds.iterations100.push_back(benchmark.Play(Iterations100()));
    rounds.chosen.push_back(benchmark.Play({}));
    const auto [plain, ours] = benchmark.Compare(Iterations100());
    rounds.plain_ms.push_back(plain);
    rounds.ours_ms.push_back(ours);
    rounds.steps_per_s.push_back(benchmark.RolloutSteps());
    MeasureTrees(benchmark, rounds);
    for (std::size_t budget = 0; budget < kBudgetsMs.size(); ++budget) {
      rounds.overruns[budget].push_back(benchmark.Overruns(kBudgetsMs[budget]));
    }
  }
  const auto metrics = Metrics(rounds);
  const auto value = [&](const char* name) { return metrics[name].get<double>(); };
  fmt::print(
      "{}; one thread, processor time, medians of {} rounds; decisions of {} episodes in\n"
      "mazes of 13 x 13 with a simulated operator and the network inside the planner\n\n",
      Machine(), options.rounds, options.episodes);
  fmt::print("{:<22} {:>6} {:>6} {:>6} {:>8} {:>10} {:>12} {:>10}\n", "a decision, ms", "p50",
             "p95", "p99", "network", "remembered", "decisions/s", "robots");
  fmt::print("{:<22} {:>6} {:>6} {:>6} {:>8} {:>10} {:>12} {:>10}\n", "", "", "", "", "passes",
             "look-ups", "and core", "at 5 Hz");
  PrintRow(rounds, "100 iterations", rounds.iterations100);
  PrintRow(rounds, "default preset", rounds.chosen);
  fmt::print(
      "\nthe same {} decisions (100 iterations) by the search written plainly: "
      "{:.1f} x the time, the same choices\n",
      benchmark.situations(), value("plain_ratio"));
  fmt::print("rollouts without pictures: {:.1f} M moves/s, {:.1f} ns a move\n",
             1e-6 * value("rollout_steps_per_s"), 1e9 / value("rollout_steps_per_s"));
  fmt::print(
      "four trees of the default preset for one robot, the same choices on all, wall time p50: "
      "{:.2f} ms on 1 thread,\n{:.2f} ms on 2, {:.2f} ms on 4\n",
      value("trees4_threads1_p50_ms"), value("trees4_threads2_p50_ms"),
      value("trees4_threads4_p50_ms"));
  PrintOverruns(rounds);
  WriteFigures(options.json, {{"benchmark", "planner"},
                              {"machine", Machine()},
                              {"rounds", options.rounds},
                              {"metrics", metrics}});
}

}  // namespace
}  // namespace conav::bench

int main(int argc, char** argv) {
  CLI::App app(
      "What a decision of IG-MCTS costs with the network inside the planner: 100 iterations,\n"
      "the default preset, rollouts alone, and the same search written plainly\n"
      "(a whole pass of the network for each query, nothing remembered), which must decide alike.\n"
      "Metrics of --json: iterations100_p50_ms, iterations100_p95_ms, default_p50_ms, "
      "default_p95_ms,\n"
      "rollout_steps_per_s, plain_ratio (plain over ours), robots_per_core_5hz,\n"
      "trees4_threads1_p50_ms, trees4_threads2_p50_ms, trees4_threads4_p50_ms (four trees for one\n"
      "robot, wall time), time_budget_overrun_ms_max (budgets of 1, 5 and 20 ms, processor\n"
      "time; the worst decision, each by the median of its rounds), "
      "time_budget_overrun_ms_longest\n"
      "(of all rounds: the machine's hiccups are in it).",
      "conav-bench-planner");
  conav::bench::Options options;
  conav::bench::AddUsualOptions(app, options.json, options.rounds);
  app.add_option("--episodes", options.episodes, "Episodes whose decisions are made")
      ->capture_default_str()
      ->check(CLI::Range(1, 1000));
  app.add_option("--weights", options.weights, "Of the network (the ones that come with conav)");
  return conav::bench::RunBenchmark(app, argc, argv, [&] { conav::bench::Run(options); });
}
