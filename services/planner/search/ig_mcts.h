#pragma once

#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "common/msg/perception_model.h"
#include "common/runtime/random.h"
#include "planner/search/rollout.h"
#include "planner/search/search_options.h"
#include "planner/search/search_problem.h"
#include "planner/search/search_tree.h"

// One user: parallel_search; it is the algorithm.

namespace conav::planner {

/// Information Gain Monte Carlo Tree Search: decides whether a robot moves, and where to, or shows
/// the operator a view, and which. One tree; ParallelSearch makes a decision of one tree or several.
///
/// A node is the path since the last picture. The operator's belief is the same in all nodes, as a
/// communication ends its branch (A12) and a move tells the operator nothing. Each iteration:
///   1. Selection: from the root down by UCB while all actions of a node were tried.
///   2. Expansion: an untried action becomes a child, its reward is computed (reward.h).
///   3. Rollout: random actions from there (rollout.h).
///   4. Backup: the return goes up to the root, weighted by feasibility (search_tree.h).
/// The chosen action is the most visited one of the root.
///
/// Limits:  at most 64 actions at a vertex. About 100 bytes of memory per iteration, and the views'
///          information. An iteration asks the model about at most one view and allocates nothing.
/// Repeats: the same problem, options and state of `random` give the same tree.
/// Threads: one at a time.
/// Sources: the paper, section 5 and appendix E; docs/paper.md says how conav reads it. UCT: Kocsis
///          and Szepesvari, "Bandit Based Monte-Carlo Planning", ECML 2006.
class IgMcts {
 public:
  /// All arguments must outlive this.
  IgMcts(const SearchOptions& options, const SearchProblem& problem, PerceptionModel& model,
         Random& random);

  /// Continues from an earlier tree, whose root is the problem's start. Before Start(); ignored if
  /// only one of them keeps terms.
  void ContinueFrom(SearchTree tree);

  /// Prepares the root: asks about its views, in one batch, and withholds those that are not worth
  /// sending. False when there is nothing to decide. Errors: those of the perception model, as of
  /// Iterate().
  [[nodiscard]] Result<bool> Start();
  /// Stages 1 to 4 once. Requires Start() == true.
  [[nodiscard]] Result<void> Iterate();

  SearchResult Report();
  /// The cells along the most visited actions, as SearchResult::expected_path; from `action` of the
  /// root on if given.
  std::vector<Cell> ExpectedPath(std::optional<int> action = std::nullopt) const;

  const OfferedActions& offered() const { return offered_; }
  /// Ends the search.
  SearchTree TakeTree() { return std::move(tree_); }

 private:
  int Select(int node);                            // stage 1: one step down
  [[nodiscard]] Result<int> Expand(int node);      // stage 2
  [[nodiscard]] Result<double> RollOut(int leaf);  // stage 3
  void Backup(int leaf, double rollout_return);    // stage 4

  bool IsFullyExpanded(int node);
  int UntriedAction(const Actions& actions, std::uint64_t tried);
  int AddMove(int parent, int action, const Edge& edge);
  [[nodiscard]] Result<int> AddCommunication(int parent, int action, const Actions& actions);
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
