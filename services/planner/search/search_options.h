#pragma once

#include <algorithm>
#include <optional>
#include <string>

#include "common/runtime/clock.h"
#include "common/runtime/threads.h"
#include "planner/search/reward.h"

namespace conav::planner {

/// How many nodes one iteration adds (docs/paper.md A3).
enum class Expansion {
  kSingle,  // one, then a rollout: section 5.2 and the authors' earlier code
  kChain,   // until a communication, a terminal node or the cap: algorithm 1 read literally
};

/// Which untried action an expansion takes.
enum class UntriedOrder { kMovesFirst, kRandom };

/// What a backup adds to Q (docs/paper.md A1).
enum class BackupRule {
  kPropagatedSample,  // q_sample: equation 3
  kRolloutReturn,     // q: as printed in procedure BackPropagate, a misprint; kept to show that
};

/// What a search takes over from the one before, when the robot has moved along a branch of it and
/// the operator's map, path and the goals are what they were.
enum class TreeReuse {
  kNone,
  kUnchanged,  // the branch, if the robot's own map has not changed either
  kPruned,     // the branch, without what its map has ruled out since
};

/// What a search tells of itself beside its choice.
enum class SearchDetail {
  kActions,  // visits and value of each root action
  kTerms,    // and what the values are made of
  kTree,     // and the most visited nodes, and the views that were asked about
};

/// What is asked of the perception model when a view of a place is wanted. The root's views are
/// asked about in one batch, before the first iteration.
enum class ViewQuestions {
  kSingle,  // that view: fewest questions
  kPlace,   // all views of the place that are not known yet, in one batch: fewest round trips
};

/// Parameters of IG-MCTS. Defaults are what an experiment chose (docs/search.md); PaperOptions()
/// are the printed numbers.
struct SearchOptions {
  /// n: budget of a decision. With `time_budget_ms` > 0 the decision ends at that wall time too,
  /// whichever is first.
  int iterations = 2000;
  double time_budget_ms = 0.0;
  /// Trees that grow side by side from the same root, n iterations each, and the threads that they
  /// grow on: for a single robot on a machine with idle cores. Threads change no result, unless
  /// time runs out.
  int trees = 1;
  int tree_threads = 1;
  double exploration_constant = 5.0;  // k; returns are not normalised (A28)
  double discount = 0.99;             // gamma
  int rollout_depth = 100;            // d: steps of a rollout, and depth of the tree
  Expansion expansion = Expansion::kSingle;
  int chain_depth = 10;  // nodes that one iteration may add when expansion is kChain
  UntriedOrder untried_order = UntriedOrder::kRandom;
  BackupRule backup = BackupRule::kPropagatedSample;
  /// Selection weighs a child's value by its feasibility (A7): delta Q'/N' + (1 - delta) Q/N.
  bool selection_uses_feasibility = false;
  /// Selection adds guidance_prior / (1 + N) to a move onto the operator's path, a head start that
  /// visits use up (progressive bias; Chaslot and others 2008). 0 = none.
  double guidance_prior = 0.0;
  TreeReuse tree_reuse = TreeReuse::kNone;
  ViewQuestions view_questions = ViewQuestions::kSingle;  // of no influence on what is decided
  /// Offer views again that were sent already (the paper has no rule against it, A30).
  bool offers_sent_views = false;
  /// Below the root a picture is worth max(0, R_info - c - turn): the robot need not send it, and
  /// the branch ends there without it (only where a view is offered; elsewhere it goes on). At the
  /// root one is tried only if that is above 0. Without this (the paper) nearly every branch ends
  /// with a picture or a goal, so that what a picture costs is paid in all and only postpones
  /// pictures.
  bool optional_pictures = true;
  /// A view is sent only if it is expected to change at least this many cells of the operator's
  /// map. Holds for the decision itself, not deeper in the tree, where a communication stands for
  /// "stop here": a robot that has nothing to tell goes on instead of sending its views one by one.
  double min_information = 0.1;
  /// Probability that a rollout step communicates; below 0 = uniform over all actions (A6).
  double rollout_communication_probability = -1.0;
  RewardOptions reward;
  /// Changes no decision.
  SearchDetail report = SearchDetail::kTerms;

  void Visit(ConfigReader& reader);
};

/// Whether the robot may send a view now that tells `information` and is worth `reward`.
inline bool IsWorthSending(double information, double reward, const SearchOptions& options) {
  return information >= options.min_information && (!options.optional_pictures || reward > 0.0);
}

/// As printed in appendix E, algorithm 1: 100 iterations, k = sqrt 2, gamma = 0.99, depth 100, and
/// no rule against sending a view again. Hardly ever reaches the goals (docs/search.md).
SearchOptions PaperOptions();

/// When to stop early, beyond the options' budget.
struct SearchLimits {
  const StopToken* stop = nullptr;
  /// Needed for the options' time budget and for `deadline`.
  const Clock* clock = nullptr;
  std::optional<Clock::TimePoint> deadline;
};

/// When a decision has to end: at the earliest of the caller's deadline and the options' time
/// budget, which begins to run at construction. Threads: const and safe to call concurrently, where
/// the clock is.
class SearchBudget {
 public:
  SearchBudget(const SearchOptions& options, const SearchLimits& limits)
      : limits_(limits), deadline_(limits.deadline) {
    if (limits.clock == nullptr || options.time_budget_ms <= 0.0) return;
    const auto end = limits.clock->Now() + Seconds(1e-3 * options.time_budget_ms);
    deadline_ = deadline_ ? std::min(end, *deadline_) : end;
  }

  /// One look at the clock, where there is a deadline.
  bool IsSpent() const {
    if (limits_.stop != nullptr && limits_.stop->stop_requested()) return true;
    return deadline_ && limits_.clock->Now() >= *deadline_;
  }

 private:
  SearchLimits limits_;
  std::optional<Clock::TimePoint> deadline_;
};

}  // namespace conav::planner
