#pragma once

#include <array>
#include <string>

#include "common/runtime/config.h"

namespace conav::planner {

/// Who decides that method ig-mcts sends a picture (docs/methods.md): the search itself, or, for
/// comparison, a rule beside it; then the search decides the moves only.
inline constexpr std::array kCommunicationPolicies{"search", "never",        "random",
                                                   "every",  "when_blocked", "threshold"};

/// Section `communication` of the planner.
struct CommunicationConfig {
  std::string policy = "search";  // one of kCommunicationPolicies
  double probability = 0.2;       // random: of a picture, per decision
  int every_moves = 5;            // every: a picture is due when so many moves were made since
  double threshold_cells = 1.0;   // threshold: expected edits that make a view worth sending
  /// Expected edits that a radian of turning outweighs when a rule's heading is chosen; 0 = the
  /// most informative view, wherever it looks.
  double turn_cost = 0.0;

  void Visit(ConfigReader& reader) {
    reader.Choice("policy", policy, {kCommunicationPolicies.begin(), kCommunicationPolicies.end()});
    reader.Field("probability", probability, 0.0, 1.0);
    reader.Field("every_moves", every_moves, 1, 1'000'000);
    reader.Field("threshold_cells", threshold_cells, 0.0, 1e6);
    reader.Field("turn_cost", turn_cost, 0.0, 1e6);
  }
};

}  // namespace conav::planner
