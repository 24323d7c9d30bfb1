#pragma once

#include <span>
#include <vector>

#include "common/msg/perception_model.h"
#include "common/runtime/random.h"
#include "planner/search/search_options.h"
#include "planner/search/search_problem.h"
#include "planner/search/tree_reuse.h"

// One user: the method; the algorithm does not know it.

namespace conav::planner {

/// Makes a decision: runs IgMcts until the budget is spent, with SearchOptions::trees > 1 as several
/// trees side by side, each with its own random numbers and remembered views, on several threads if
/// asked for; then adds up their visits and returns at the root (SumOfTrees). Keeps the trees for the
/// robot's next decision if asked for (SearchMemory).
///
/// Time: looks at the clock once when the decision begins and once after each iteration, which asks
/// the model for at most one view; the decision ends at the first look past its time budget. It does
/// not interrupt a question to the model: the model's own timeout bounds it
/// (planner.perception_timeout_s). So a decision ends at most one iteration and one such timeout
/// after its budget; one more if the batch of the root's views, asked before the first iteration,
/// used up all of the time.
///
/// Repeatable: the same problem, options and state of `random` give the same trees, with any number
/// of threads, unless time runs out.
class ParallelSearch {
 public:
  /// `model` must outlive this.
  ParallelSearch(const SearchOptions& options, PerceptionModel& model);

  /// One decision. Makes at least one iteration if a move or a view worth sending is offered and a
  /// goal is left.
  /// With `memories`, a vector per robot that begins empty, it continues with the trees of the
  /// robot's previous decision, where the options allow it, and leaves its own.
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
