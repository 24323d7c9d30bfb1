#pragma once

#include <array>
#include <string>

#include "common/runtime/config.h"
#include "planner/search/paper_preset.h"
#include "planner/search/search_options.h"
#include "planner/search/search_tree.h"

namespace conav::planner {

/// The policies that decide when method ig-mcts sends a picture (docs/tradeoff.md): the search, or,
/// for comparison, a rule; then the search decides the moves only.
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

/// The search of method ig-mcts.
struct SearchConfig {
  /// "default" reaches the goals; "paper" and "paper-literal" start from what the paper prints, with
  /// which the robot does not (search/paper_preset.h). Other keys of this section change single
  /// values of it.
  std::string preset = "default";
  /// Camera headings offered per cell; with the four moves they must fit the search's 64 actions.
  int headings = 8;
  /// Prior of the operator's measured reliability, in edits of the operator's map
  /// (OperatorReliability); 0 = nothing is measured, pictures are worth what the perception model
  /// says.
  double reliability_prior = 1.0;
  /// Whether an operator's path still guides once the robot knows of a wall on it (the paper has no
  /// rule), also behind the robot. If not, it counts as none until the operator draws another:
  /// otherwise the penalty for being off the path holds the robot to a path that it cannot follow.
  bool blocked_path_guides = false;
  SearchOptions options;

  void Visit(ConfigReader& reader) {
    reader.Choice("preset", preset, {"default", "paper", "paper-literal"});
    if (preset != "default" && reader.reading()) {
      options = preset == "paper" ? PaperOptions() : LiteralPaperOptions();
      reliability_prior = kPaperReliabilityPrior;
      blocked_path_guides = kPaperBlockedPathGuides;
    }
    reader.Field("headings", headings, 1, kMaxActions - 4);
    reader.Field("reliability_prior", reliability_prior, 0.0, 1e6);
    reader.Field("blocked_path_guides", blocked_path_guides);
    options.Visit(reader);
  }
};

/// How method ig-mcts is set up; the others need nothing.
struct MethodConfig {
  SearchConfig search;
  CommunicationConfig communication;
};

}  // namespace conav::planner
