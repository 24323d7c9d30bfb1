#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>

#include "common/runtime/clock.h"
#include "common/runtime/threads.h"
#include "planner/search/reward.h"

namespace conav::planner {

/// How an iteration expands the tree. The presets choose it; the configuration has no key for it.
enum class Expansion {
  kRandom,      // one untried action, drawn at random
  kMovesFirst,  // one untried action, the moves before the views (paper_preset.h)
  kChain,       // several of these, kMostOfChain at most: algorithm 1 read literally (A3)
};
inline constexpr int kMostOfChain = 10;

/// What a search keeps of the previous one when the robot has moved along a branch of its tree and
/// the operator's map, the operator's path and the goals are the same.
enum class TreeReuse {
  kNone,
  kPruned,  // the branch, without the actions that the robot's own map has ruled out since
};
inline constexpr std::array kTreeReuses{TreeReuse::kNone, TreeReuse::kPruned};
constexpr std::string_view Name(TreeReuse reuse) {
  return reuse == TreeReuse::kNone ? "none" : "pruned";
}

/// What a search reports besides its choice.
enum class SearchDetail {
  kActions,  // visits and value of each root action
  kTerms,    // and the terms of these values
  kTree,     // and the most visited nodes, and the views that were asked about
};
inline constexpr std::array kSearchDetails{SearchDetail::kActions, SearchDetail::kTerms,
                                           SearchDetail::kTree};
constexpr std::string_view Name(SearchDetail detail) {
  switch (detail) {
    case SearchDetail::kActions:
      return "actions";
    case SearchDetail::kTerms:
      return "terms";
    case SearchDetail::kTree:
      return "tree";
  }
  return "";
}

/// Parameters of IG-MCTS. The defaults won the experiments of docs/search.md; paper_preset.h holds
/// the numbers of the paper.
struct SearchOptions {
  /// n: budget of a decision. With `time_budget_ms` > 0 the decision also ends after that much wall
  /// time, whichever comes first.
  int iterations = 2000;
  double time_budget_ms = 0.0;
  /// Number of trees that grow side by side from the same root, n iterations each, and of the
  /// threads that they grow on: for a single robot on a machine with idle cores. The number of
  /// threads changes no result, unless time runs out.
  int trees = 1;
  int tree_threads = 1;
  double exploration_constant = 5.0;  // k; returns are not normalised (A28)
  double discount = 0.99;             // gamma
  int rollout_depth = 100;            // d: steps of a rollout, and depth of the tree
  Expansion expansion = Expansion::kRandom;
  TreeReuse tree_reuse = TreeReuse::kNone;
  /// Offer views again that were sent already (the paper has no rule against it, A30).
  bool offers_sent_views = false;
  /// Below the root a picture is worth max(0, R_info - c - turn): the robot need not send it, and
  /// the branch ends there without it (only where a view is offered; elsewhere it goes on). At the
  /// root a picture is tried only if that is above 0. Without this option (the paper) nearly every
  /// branch ends with a picture or a goal, so every branch pays for one picture, and the cost only
  /// postpones pictures.
  bool optional_pictures = true;
  /// A view is sent only if its information (R_info, SearchAction::information_gain) is at least this.
  /// The limit holds for the decision itself, not deeper in the tree, where a communication
  /// stands for "stop here": a robot without news moves on instead of sending its views one by one.
  double min_information = 0.1;
  RewardOptions reward;
  /// Changes no decision.
  SearchDetail report = SearchDetail::kTerms;

  void Visit(ConfigReader& reader);
};

/// Whether the robot may send a view now that tells `information` and is worth `reward`.
inline bool IsWorthSending(double information, double reward, const SearchOptions& options) {
  return information >= options.min_information && (!options.optional_pictures || reward > 0.0);
}

/// What may end a decision before its iterations are used up.
struct SearchLimits {
  const StopToken* stop = nullptr;
  const Clock* clock = nullptr;  // needed for the options' time budget
};

/// When a decision has to end; the time budget starts at construction.
/// Threads: const and safe to call concurrently if the clock is.
class SearchBudget {
 public:
  SearchBudget(const SearchOptions& options, const SearchLimits& limits) : limits_(limits) {
    if (options.time_budget_ms <= 0.0) return;
    deadline_ = limits.clock->Now() + Seconds(1e-3 * options.time_budget_ms);
  }

  /// Looks at the clock once if there is a budget of time.
  bool IsSpent() const {
    if (limits_.stop != nullptr && limits_.stop->stop_requested()) return true;
    return deadline_ && limits_.clock->Now() >= *deadline_;
  }

 private:
  SearchLimits limits_;
  std::optional<Clock::TimePoint> deadline_;
};

}  // namespace conav::planner
