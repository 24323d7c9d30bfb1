#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "planner/decision/method.h"
#include "planner/search/grid_graph.h"
#include "planner/search/search_problem.h"

namespace conav::planner {

/// The views of the situation's camera in `headings` directions: `kept` if it is of the same
/// camera.
std::shared_ptr<const GridViews> ViewsFor(const Situation& situation, int headings,
                                          std::shared_ptr<const GridViews> kept = nullptr);

/// How far the search relies on the operator.
struct Reliance {
  /// What a view tells the operator is multiplied by this, in [0, 1].
  double information_weight = 1.0;
  /// Whether a path on which the robot knows of a wall, ahead of it or behind, still guides it; if
  /// not, it counts as none.
  bool blocked_path_guides = false;
};

/// A robot's situation as the search sees it: the problem and the graph that it refers to.
class SituationProblem {
 public:
  /// `belief` is what the operator's map is taken to be, `withheld` views that are not offered.
  /// `views` stand for the situation's camera (ViewsFor).
  SituationProblem(const Situation& situation, BeliefGrid belief, std::vector<SentView> withheld,
                   std::shared_ptr<const GridViews> views, const Reliance& reliance = {});
  SituationProblem(const SituationProblem&) = delete;
  SituationProblem& operator=(const SituationProblem&) = delete;

  /// Null when the robot's cell cannot be free on its map.
  const SearchProblem* get() const { return problem_ ? &*problem_ : nullptr; }

 private:
  GridGraph graph_;
  BeliefGrid belief_;
  std::optional<SearchProblem> problem_;
};

}  // namespace conav::planner
