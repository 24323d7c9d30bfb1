#pragma once

#include <span>
#include <vector>

#include "common/runtime/random.h"
#include "planner/search/perception_model.h"
#include "planner/search/search_options.h"
#include "planner/search/search_problem.h"
#include "planner/search/tree_reuse.h"

namespace conav::planner {

/// What several trees of the same root have found together (root parallelisation: Chaslot, Winands
/// and van den Herik, "Parallel Monte-Carlo Tree Search", 2008): visits and returns of each root
/// action summed in the order of the trees, the most visited action chosen, counts summed, views
/// put together. A tree without actions, because its turn never came, adds nothing. No
/// expected_path and no tree. Requires a tree.
SearchResult SumOfTrees(std::span<const SearchResult> trees);

/// The first of the trees that visited root action `action` most.
std::size_t TreeWithMostVisits(std::span<const SearchResult> trees, std::size_t action);

/// Information Gain Monte Carlo Tree Search (the paper's section 5 and appendix E): decides whether
/// a robot moves, and where to, or shows the operator a view, and which.
///
/// A node is the path since the last picture; the operator's belief is the same in all nodes, as a
/// communication ends its branch (A12) and a move tells the operator nothing. Each iteration:
///   1. Selection: from the root down by UCB while all actions of a node were tried.
///   2. Expansion: one untried action becomes a child (or a chain of them, see Expansion).
///   3. Rollout: random actions from there; see rollout.h.
///   4. Backup: the return goes up, weighed by feasibility; see search_tree.h.
/// The chosen action is the most visited at the root.
///
/// With SearchOptions::trees > 1 that many trees grow side by side, each with random numbers and
/// remembered views of its own, on several threads where asked for; their visits and returns at the
/// root are summed (sum_of_trees.h).
///
/// Time: the clock is looked at once when the decision begins and once after each iteration, which
/// asks the model for at most one view; the decision ends at the first look past the deadline. A
/// question under way is not interrupted: what bounds it is the model's own timeout
/// (planner.perception_timeout_s). So a decision ends one iteration and one such timeout after its
/// deadline at the latest; one more where already the batch of the root's views, asked before the
/// first iteration, took all of the time.
///
/// Limits: at most 64 actions at a vertex. Memory: about 100 bytes per iteration, and the views'
/// information. Repeatable: the same problem, options and state of `random` give the same trees,
/// whatever the number of threads, unless time runs out.
class IgMcts {
 public:
  /// `model` must outlive this.
  IgMcts(const SearchOptions& options, PerceptionModel& model);

  /// One decision. At least one iteration is made, if a move or a view worth sending is offered
  /// and a goal is left.
  /// With `memories`, a vector per robot that begins empty, it goes on with the trees of the
  /// robot's decision before, as far as the options say, and leaves its own.
  /// Errors: those of the perception model; nothing was decided then.
  /// Threads: concurrent calls are fine with a `random` each.
  [[nodiscard]] Result<SearchResult> Decide(const SearchProblem& problem, Random& random,
                                            const SearchLimits& limits = {},
                                            std::vector<SearchMemory>* memories = nullptr) const;

 private:
  SearchOptions options_;
  PerceptionModel& model_;
};

}  // namespace conav::planner
