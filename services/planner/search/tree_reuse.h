#pragma once

#include <optional>
#include <vector>

#include "planner/search/search_problem.h"
#include "planner/search/search_tree.h"

// One user: parallel_search; the algorithm does not know it.

namespace conav::planner {

/// Keeps the tree of a robot's newest decision for the next one (SearchOptions::tree_reuse).
class SearchMemory {
 public:
  /// Keeps `tree`, which belongs to `problem`.
  void Keep(const SearchProblem& problem, SearchTree tree);

  /// The branch of the kept tree that begins where `problem` begins, if the robot has made one move
  /// of that tree since, and belief, guidance and goals are the same. Leaves out the actions that
  /// are no longer offered, and at the root the pictures that are not worth sending
  /// (IsWorthSending).
  std::optional<SearchTree> BranchFor(const SearchProblem& problem, OfferedActions& offered,
                                      const SearchOptions& options) const;

 private:
  struct Kept {
    SearchTree tree;
    std::vector<Cell> path;  // tau_0, the start last
    std::vector<Cell> goals_left;
    std::vector<Cell> guidance;
    bool guided_before;
    SharedBelief belief;
    double information_weight;
    double answer_value;
  };

  std::optional<Kept> kept_;
};

}  // namespace conav::planner
