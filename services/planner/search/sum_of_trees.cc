#include "planner/search/sum_of_trees.h"

#include <algorithm>
#include <utility>

#include "planner/search/reported_tree.h"

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
  int best = -1;
  for (std::size_t i = 0; i < actions.size(); ++i) {
    if (actions[i].visits == 0) continue;
    if (best >= 0) {
      const SearchAction& known = actions[static_cast<std::size_t>(best)];
      if (actions[i].visits < known.visits) continue;
      if (actions[i].visits == known.visits && actions[i].mean_value <= known.mean_value) continue;
    }
    best = static_cast<int>(i);
  }
  return best;
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

}  // namespace conav::planner
