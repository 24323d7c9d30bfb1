#pragma once

#include <optional>

#include "common/runtime/clock.h"
#include "common/runtime/random.h"
#include "common/runtime/stop_token.h"
#include "planner/search/perception_model.h"
#include "planner/search/search_memory.h"
#include "planner/search/search_options.h"
#include "planner/search/search_problem.h"

namespace conav::planner {

/// When to stop early, beyond the options' budget.
struct SearchLimits {
  const StopToken* stop = nullptr;
  /// Needed for the options' time budget and for `deadline`.
  const Clock* clock = nullptr;
  std::optional<Clock::TimePoint> deadline;
};

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
/// Limits: at most 64 actions at a vertex. Memory: about 100 bytes per iteration, and the views'
/// information. Repeatable: the same problem, options and state of `random` give the same tree.
class IgMcts {
 public:
  /// `model` must outlive this.
  IgMcts(const SearchOptions& options, PerceptionModel& model);

  /// One decision. At least one iteration is made, if any action is offered and a goal is left.
  /// With a `memory`, one per robot, it goes on with the tree of the robot's decision before, as far
  /// as the options say, and leaves its own.
  /// Errors: those of the perception model; nothing was decided then.
  /// Threads: concurrent calls are fine with a `random` and a graph each.
  [[nodiscard]] Result<SearchResult> Decide(const SearchProblem& problem, Random& random,
                                            const SearchLimits& limits = {},
                                            SearchMemory* memory = nullptr) const;

 private:
  SearchOptions options_;
  PerceptionModel& model_;
};

}  // namespace conav::planner
