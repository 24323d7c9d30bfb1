#include "planner/search/parallel_search.h"

#include <algorithm>
#include <memory>
#include <utility>

#include "common/runtime/result.h"
#include "common/runtime/threads.h"
#include "planner/search/ig_mcts.h"
#include "planner/search/search_tree.h"
#include "planner/search/view_information.h"

namespace conav::planner {
namespace {

void AddAction(const SearchAction& of_tree, SearchAction& sum) {
  if (of_tree.visits == 0) return;
  const double total_return = sum.mean_value * sum.visits + of_tree.mean_value * of_tree.visits;
  RewardTerms terms = static_cast<double>(sum.visits) * sum.terms;
  terms += static_cast<double>(of_tree.visits) * of_tree.terms;
  sum.visits += of_tree.visits;
  sum.terms = 1.0 / sum.visits * terms;
  sum.mean_value = total_return / sum.visits;
  sum.information_gain = std::max(sum.information_gain, of_tree.information_gain);
}

void AddTree(const SearchResult& tree, SearchResult& sum) {
  for (std::size_t i = 0; i < tree.actions.size(); ++i) AddAction(tree.actions[i], sum.actions[i]);
  sum.views.insert(sum.views.end(), tree.views.begin(), tree.views.end());
  sum.iterations += tree.iterations;
  sum.nodes += tree.nodes;
  sum.perception_queries += tree.perception_queries;
  sum.perception_calls += tree.perception_calls;
  sum.perception_cached += tree.perception_cached;
}

/// As SearchTree::MostVisitedChild (A27); -1 when none was visited.
int MostVisited(std::span<const SearchAction> actions) {
  const auto best = std::ranges::max_element(actions, {}, [](const SearchAction& action) {
    return std::pair(action.visits, action.mean_value);
  });
  return best == actions.end() || best->visits == 0 ? -1 : static_cast<int>(best - actions.begin());
}

}  // namespace

SearchResult SumOfTrees(std::span<const SearchResult> trees) {
  SearchResult sum = trees.front();
  for (const SearchResult& tree : trees.subspan(1)) AddTree(tree, sum);
  sum.views = MostOfEach(std::move(sum.views), kMaxReportedViews);
  sum.tree.clear();
  sum.expected_path.clear();
  sum.chosen = MostVisited(sum.actions);
  return sum;
}

std::size_t TreeWithMostVisits(std::span<const SearchResult> trees, std::size_t action) {
  const auto visits = [&](std::size_t tree) {
    return action < trees[tree].actions.size() ? trees[tree].actions[action].visits : 0;
  };
  std::size_t best = 0;
  for (std::size_t tree = 1; tree < trees.size(); ++tree) {
    if (visits(tree) > visits(best)) best = tree;
  }
  return best;
}

namespace {

/// The trees of one decision.
class Trees {
 public:
  Trees(const SearchOptions& options, const SearchProblem& problem, PerceptionModel& model,
        Random& random, std::vector<SearchMemory>* memories)
      : options_(options), problem_(problem), model_(model), memories_(memories) {
    const auto count = static_cast<std::size_t>(options.trees);
    trees_.resize(count);
    if (memories != nullptr) memories->resize(count);
    if (count > 1) SeedTrees(random.Next());
    MakeTree(0, count > 1 ? randoms_.front() : random);
  }

  /// Asks about the root. False when there is nothing to decide.
  Result<bool> Start() { return trees_.front()->Start(); }
  Result<void> Grow(const SearchBudget& budget);
  SearchResult Report();
  void LeaveToMemories();

 private:
  void SeedTrees(std::uint64_t seed);
  void MakeTree(std::size_t tree, Random& random);
  Result<void> GrowShare(std::size_t first, std::size_t step, const SearchBudget& budget);

  const SearchOptions& options_;
  const SearchProblem& problem_;
  PerceptionModel& model_;
  std::vector<SearchMemory>* memories_;
  std::vector<Random> randoms_;  // one a tree; none for a single tree
  std::vector<std::unique_ptr<IgMcts>> trees_;
};

void Trees::SeedTrees(std::uint64_t seed) {
  randoms_.reserve(trees_.size());
  for (std::size_t tree = 0; tree < trees_.size(); ++tree) {
    randoms_.emplace_back(DeriveSeed(seed, tree));
  }
}

void Trees::MakeTree(std::size_t tree, Random& random) {
  trees_[tree] = std::make_unique<IgMcts>(options_, problem_, model_, random);
  if (memories_ == nullptr) return;
  auto branch = (*memories_)[tree].BranchFor(problem_, trees_[tree]->offered(), options_);
  if (branch) trees_[tree]->ContinueFrom(*std::move(branch));
}

Result<void> Trees::Grow(const SearchBudget& budget) {
  const std::size_t threads =
      std::min(trees_.size(), static_cast<std::size_t>(options_.tree_threads));
  std::vector<Result<void>> ends(threads);
  RunOnWorkers(static_cast<int>(threads), static_cast<int>(threads), [&](int, int share) {
    const auto first = static_cast<std::size_t>(share);
    ends[first] = GrowShare(first, threads, budget);
  });
  for (auto& end : ends) {
    if (!end) return end;
  }
  return {};
}

/// Trees first, first + step, ...: an iteration each in turn, so that they share the time evenly.
Result<void> Trees::GrowShare(std::size_t first, std::size_t step, const SearchBudget& budget) {
  for (std::size_t tree = first; tree < trees_.size(); tree += step) {
    if (tree == 0) continue;
    MakeTree(tree, randoms_[tree]);
    if (const auto started = trees_[tree]->Start(); !started) {
      return tl::unexpected(started.error());
    }
  }
  for (int i = 0; i < options_.iterations; ++i) {
    for (std::size_t tree = first; tree < trees_.size(); tree += step) {
      if (const auto done = trees_[tree]->Iterate(); !done) return done;
      if (budget.IsSpent()) return {};
    }
  }
  return {};
}

SearchResult Trees::Report() {
  if (trees_.size() == 1) return trees_.front()->Report();
  std::vector<SearchResult> of_tree;
  for (const auto& tree : trees_) {
    of_tree.push_back(tree ? tree->Report() : SearchResult{});
  }
  SearchResult sum = SumOfTrees(of_tree);
  if (sum.chosen < 0) return sum;
  const std::size_t surest = TreeWithMostVisits(of_tree, static_cast<std::size_t>(sum.chosen));
  sum.expected_path = trees_[surest]->ExpectedPath(sum.chosen);
  sum.tree = std::move(of_tree[surest].tree);
  return sum;
}

void Trees::LeaveToMemories() {
  if (memories_ == nullptr) return;
  for (std::size_t tree = 0; tree < trees_.size(); ++tree) {
    if (trees_[tree]) (*memories_)[tree].Keep(problem_, trees_[tree]->TakeTree());
  }
}

}  // namespace

ParallelSearch::ParallelSearch(const SearchOptions& options, PerceptionModel& model)
    : options_(options), model_(model) {}

Result<SearchResult> ParallelSearch::Decide(const SearchProblem& problem, Random& random,
                                            const SearchLimits& limits,
                                            std::vector<SearchMemory>* memories) const {
  DEMAND(limits.clock != nullptr || options_.time_budget_ms <= 0.0);
  const SearchBudget budget(options_, limits);
  SearchProblem offered = problem;
  if (options_.offers_sent_views) offered.sent_views.clear();
  const bool remembers = options_.tree_reuse != TreeReuse::kNone;
  Trees trees(options_, offered, model_, random, remembers ? memories : nullptr);
  const Result<bool> has_choice = trees.Start();
  if (!has_choice) return tl::unexpected(has_choice.error());
  if (!*has_choice) return trees.Report();
  if (const auto grown = trees.Grow(budget); !grown) return tl::unexpected(grown.error());
  SearchResult result = trees.Report();
  trees.LeaveToMemories();
  return result;
}

}  // namespace conav::planner
