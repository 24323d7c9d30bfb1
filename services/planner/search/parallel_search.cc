#include "planner/search/parallel_search.h"

#include <algorithm>
#include <memory>
#include <utility>

#include "common/runtime/result.h"
#include "common/runtime/threads.h"
#include "planner/search/ig_mcts.h"
#include "planner/search/tree_report.h"

namespace conav::planner {
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
    const std::uint64_t seed = count > 1 ? random.Next() : 0;
    for (std::size_t tree = 0; count > 1 && tree < count; ++tree) {
      randoms_.emplace_back(DeriveSeed(seed, tree));
    }
    MakeTree(0, count > 1 ? randoms_.front() : random);
  }

  /// Asks about the root. False when there is nothing to decide.
  Result<bool> Start() { return trees_.front()->Start(); }
  Result<void> Grow(const SearchBudget& budget);
  SearchResult Report();
  void LeaveToMemories() {
    for (std::size_t tree = 0; memories_ != nullptr && tree < trees_.size(); ++tree) {
      if (trees_[tree]) (*memories_)[tree].Keep(problem_, trees_[tree]->TakeTree());
    }
  }

 private:
  void MakeTree(std::size_t tree, Random& random);
  Result<void> GrowShare(std::size_t first, std::size_t step, const SearchBudget& budget);

  const SearchOptions& options_;
  const SearchProblem& problem_;
  PerceptionModel& model_;
  std::vector<SearchMemory>* memories_;
  std::vector<Random> randoms_;  // one a tree; none for a single tree
  std::vector<std::unique_ptr<IgMcts>> trees_;
};

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
  sum.expected_path = ExpectedPath(trees_[surest]->tree(), problem_.graph, sum.chosen);
  sum.tree = std::move(of_tree[surest].tree);
  return sum;
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
