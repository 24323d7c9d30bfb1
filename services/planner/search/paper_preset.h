#pragma once

#include <cmath>

#include "planner/search/search_options.h"

// One user: the options; the paper's search stands in one place, for the audit.

/// Everything that the presets `paper` and `paper-literal` change of the default, in one place, to
/// audit against the paper (docs/paper.md). As printed the search hardly ever reaches the goals
/// (docs/search.md).
namespace conav::planner {

/// Appendix E: 100 iterations, k = sqrt 2, gamma = 0.99, depth 100; appendix C: c = 10 + m. One node
/// an iteration, as in section 5.2. None of our additions: no rule against sending a view again
/// (A30), every branch owes its picture, turns cost nothing, no progress term.
inline SearchOptions PaperOptions() {
  SearchOptions options;
  options.iterations = 100;
  options.exploration_constant = std::sqrt(2.0);
  options.discount = 0.99;
  options.rollout_depth = 100;
  options.expansion = Expansion::kMovesFirst;
  options.offers_sent_views = true;
  options.optional_pictures = false;
  options.min_information = 0.0;
  options.reward.communication_cost = 10.0;
  options.reward.view_turn = 0.0;
  options.reward.progress = 0.0;
  options.reward.answer = 0.0;
  return options;
}

/// The same with algorithm 1 read literally (A3): an iteration expands until it meets a
/// communication or a terminal node, kMostOfChain nodes at most.
inline SearchOptions LiteralPaperOptions() {
  SearchOptions options = PaperOptions();
  options.expansion = Expansion::kChain;
  return options;
}

/// The paper's operator does what the perception model expects: nothing is measured.
inline constexpr double kPaperReliabilityPrior = 0.0;
/// The paper has no rule against guidance that leads through a known wall.
inline constexpr bool kPaperBlockedPathGuides = true;
/// An expected edit is worth 1 (appendix C, 4).
inline constexpr double kPaperMappingValue = 1.0;

}  // namespace conav::planner
