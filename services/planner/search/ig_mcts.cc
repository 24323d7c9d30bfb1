#include "planner/search/ig_mcts.h"

#include <algorithm>
#include <memory>

#include "common/runtime/demand.h"
#include "common/runtime/workers.h"
#include "planner/search/search_budget.h"
#include "planner/search/sum_of_trees.h"
#include "planner/search/tree_search.h"

namespace conav::planner {
namespace {

/// The trees of one decision, grown side by side.
class Forest {
 public:
  Forest(const SearchOptions& options, const SearchProblem& problem, PerceptionModel& model,
         Random& random, std::vector<SearchMemory>* memories)
      : options_(options), problem_(problem), model_(model), memories_(memories) {
    const auto count = static_cast<std::size_t>(options.trees);
    trees_.resize(count);
    if (memories != nullptr) memories->resize(count);
    if (count > 1) SeedTrees(random.Next());
    Plant(0, count > 1 ? randoms_.front() : random);
  }

  /// Asks about the root. False when nothing can or need be decided.
  Result<bool> Start() { return trees_.front()->Start(); }
  Result<void> Grow(const SearchBudget& budget);
  SearchResult Report();
  void LeaveToMemories();

 private:
  void SeedTrees(std::uint64_t seed);
  void Plant(std::size_t tree, Random& random);
  Result<void> GrowShare(std::size_t first, std::size_t step, const SearchBudget& budget);

  const SearchOptions& options_;
  const SearchProblem& problem_;
  PerceptionModel& model_;
  std::vector<SearchMemory>* memories_;
  std::vector<Random> randoms_;  // one a tree; none for a single tree
  std::vector<std::unique_ptr<TreeSearch>> trees_;
};

void Forest::SeedTrees(std::uint64_t seed) {
  randoms_.reserve(trees_.size());
  for (std::size_t tree = 0; tree < trees_.size(); ++tree) {
    randoms_.emplace_back(DeriveSeed(seed, tree));
  }
}

void Forest::Plant(std::size_t tree, Random& random) {
  trees_[tree] = std::make_unique<TreeSearch>(options_, problem_, model_, random,
                                              memories_ == nullptr ? nullptr : &(*memories_)[tree]);
}

Result<void> Forest::Grow(const SearchBudget& budget) {
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

/// Trees first, first + step, ...: an iteration each in turn, so that time is shared evenly.
Result<void> Forest::GrowShare(std::size_t first, std::size_t step, const SearchBudget& budget) {
  for (std::size_t tree = first; tree < trees_.size(); tree += step) {
    if (tree == 0) continue;
    Plant(tree, randoms_[tree]);
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

SearchResult Forest::Report() {
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

void Forest::LeaveToMemories() {
  if (memories_ == nullptr) return;
  for (std::size_t tree = 0; tree < trees_.size(); ++tree) {
    if (trees_[tree]) trees_[tree]->LeaveTo((*memories_)[tree]);
  }
}

}  // namespace

IgMcts::IgMcts(const SearchOptions& options, PerceptionModel& model)
    : options_(options), model_(model) {}

Result<SearchResult> IgMcts::Decide(const SearchProblem& problem, Random& random,
                                    const SearchLimits& limits,
                                    std::vector<SearchMemory>* memories) const {
  DEMAND(limits.clock != nullptr || (!limits.deadline && options_.time_budget_ms <= 0.0));
  const SearchBudget budget(options_, limits);
  SearchProblem offered = problem;
  if (options_.offers_sent_views) offered.sent_views.clear();
  const bool remembers = options_.tree_reuse != TreeReuse::kNone;
  Forest forest(options_, offered, model_, random, remembers ? memories : nullptr);
  const Result<bool> has_choice = forest.Start();
  if (!has_choice) return tl::unexpected(has_choice.error());
  if (!*has_choice) return forest.Report();
  if (const auto grown = forest.Grow(budget); !grown) return tl::unexpected(grown.error());
  SearchResult result = forest.Report();
  forest.LeaveToMemories();
  return result;
}

}  // namespace conav::planner
