#pragma once

#include <string>

#include "common/runtime/config.h"
#include "planner/search/search_options.h"
#include "planner/search/search_tree.h"

namespace conav::planner {

/// The search of method ig-mcts.
struct SearchConfig {
  /// "default" works; "paper" starts from the numbers printed in the paper, with which it does not.
  /// Other keys of this section change single values of it.
  std::string preset = "default";
  /// Camera headings offered per cell; with the four moves they must fit the search's 64 actions.
  int headings = 8;
  /// Edits of the operator's map that an operator is trusted with before it is known how far they
  /// do what is expected of them (operator_reliability.h); 0 = pictures are worth what the
  /// perception model says, whoever sees them.
  double reliability_prior = 1.0;
  /// Whether an operator's path still guides once the robot knows of a wall on it (the paper has no
  /// rule), also behind the robot. If not, it counts as none until the operator draws another:
  /// otherwise the penalty for being off the path holds the robot to a way that it cannot go.
  bool blocked_path_guides = false;
  SearchOptions options;

  void Visit(ConfigReader& reader) {
    reader.Choice("preset", preset, {"default", "paper"});
    if (preset == "paper" && reader.reading()) {
      options = PaperOptions();
      reliability_prior = 0.0;
      blocked_path_guides = true;
    }
    reader.Field("headings", headings, 1, kMaxActions - 4);
    reader.Field("reliability_prior", reliability_prior, 0.0, 1e6);
    reader.Field("blocked_path_guides", blocked_path_guides);
    options.Visit(reader);
  }
};

}  // namespace conav::planner
