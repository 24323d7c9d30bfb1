#pragma once

#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "common/runtime/random.h"
#include "planner/search/perception_model.h"
#include "planner/search/rollout.h"
#include "planner/search/search_options.h"
#include "planner/search/search_problem.h"
#include "planner/search/search_tree.h"
#include "planner/search/tree_reuse.h"

namespace conav::planner {

/// One tree of a decision: the four stages of an iteration (ig_mcts.h) and what is told of them.
/// Threads: one at a time.
class TreeSearch {
 public:
  /// All arguments but `memory` must outlive this. Goes on with the branch that it holds, if there
  /// is one for the problem.
  TreeSearch(const SearchOptions& options, const SearchProblem& problem, PerceptionModel& model,
             Random& random, const SearchMemory* memory);

  /// Prepares the root: views that are not worth sending are not tried there. False when nothing
  /// can or need be decided. Errors: those of the perception model, as of Iterate().
  [[nodiscard]] Result<bool> Start();
  [[nodiscard]] Result<void> Iterate();

  SearchResult Report();
  /// Along the most visited actions, as SearchResult::expected_path; from `action` of the root on
  /// where it is given.
  std::vector<Cell> ExpectedPath(std::optional<int> action = std::nullopt) const;
  /// Ends the search.
  void LeaveTo(SearchMemory& memory) { memory.Keep(problem_, offered_, std::move(tree_)); }

 private:
  bool IsFullyExpanded(int node);
  int Select(int node);
  [[nodiscard]] Result<int> Expand(int node);
  [[nodiscard]] Result<double> Evaluate(int leaf);
  void Backup(int leaf, double rollout_return);

  int UntriedAction(const Actions& actions, std::uint64_t tried);
  SearchNode Move(int parent, int action, const Edge& edge);
  [[nodiscard]] Result<SearchNode> Communicate(int parent, int action, const Actions& actions,
                                               RewardTerms& terms);
  SearchAction Describe(const Actions& actions, int action) const;

  const SearchOptions& options_;
  const SearchProblem& problem_;
  Random& random_;
  PathState path_;  // tau at the node that the iteration has reached
  OfferedActions offered_;
  ViewInformation information_;
  Rollout rollout_;
  SearchTree tree_;
  std::uint32_t iterations_ = 0;
};

}  // namespace conav::planner
