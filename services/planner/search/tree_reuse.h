#pragma once

#include <optional>
#include <vector>

#include "planner/search/search_problem.h"
#include "planner/search/search_tree.h"

namespace conav::planner {

/// The tree of a robot's newest decision, for the next one (SearchOptions::tree_reuse).
class SearchMemory {
 public:
  /// Keeps `tree`, which belongs to `problem` and `offered`.
  void Keep(const SearchProblem& problem, const OfferedActions& offered, SearchTree tree);

  /// The branch of the kept tree that begins where `problem` begins: if the robot has made one move
  /// of that tree since, and belief, guidance and goals are what they were. Under kUnchanged also
  /// the actions offered must be the same ones; under kPruned branches with actions that are not
  /// offered any more are left out, as are pictures at the root that are not worth sending
  /// (IsWorthSending). `nodes_expected` as in SearchTree.
  std::optional<SearchTree> BranchFor(const SearchProblem& problem, const OfferedActions& offered,
                                      const SearchOptions& options,
                                      std::size_t nodes_expected) const;

 private:
  struct Kept {
    SearchTree tree;
    OfferedActions offered;
    std::vector<Cell> path;  // tau_0, the start last
    std::vector<Cell> goals_left;
    std::vector<Cell> guidance;
    bool guided_before;
    BeliefGrid belief;
    double information_weight;
  };

  std::optional<Kept> kept_;
};

}  // namespace conav::planner
