#pragma once

#include <cstdint>
#include <vector>

#include "common/protocol/planning.h"
#include "planner/search/navigation_graph.h"

namespace conav::planner {

/// A view: where from, and in which direction.
struct SentView {
  Cell cell;
  double heading_rad = 0.0;
};

/// One decision: Problem 1 of the paper, seen from the robot's present place.
struct SearchProblem {
  const NavigationGraph& graph;
  VertexId start = 0;
  /// Where the robot looks now.
  double heading_rad = 0.0;
  /// tau_0: cells since the last picture, the present one last (added if it is missing).
  std::vector<Cell> path;
  std::vector<Cell> goals_left;
  /// zeta: the operator's path; may be empty.
  std::vector<Cell> guidance;
  /// Whether the operator has ever given this robot a path: without one there is no penalty for
  /// being off it, with one that was withdrawn there is (docs/paper.md A16).
  bool guided_before = false;
  /// x_0: what the operator takes for a wall.
  const BeliefGrid& belief;
  /// What a view's expected edits are multiplied by, in [0, 1]: how far the operator does what the
  /// perception model expects (planner/decision/operator_reliability.h). 1 in the paper.
  double information_weight = 1.0;
  /// Views that are not offered, because they were sent and nothing changed since.
  std::vector<SentView> sent_views;
};

struct SearchResult {
  /// Actions of the root in their fixed order: moves, then views. Those never tried have 0 visits.
  std::vector<SearchAction> actions;
  bool has_terms = false;
  int chosen = -1;  // index into actions; -1 = nothing can be done, or no goal is left
  std::uint32_t iterations = 0;
  std::uint32_t nodes = 0;
  std::uint32_t perception_queries = 0;  // views asked of the model
  std::uint32_t perception_calls = 0;    // batches they were asked in
  std::uint32_t perception_cached = 0;   // views looked up again within this decision
  /// Cells entered along the most visited actions, nearest first; ends where that line sends a
  /// picture, reaches a goal or was not searched further.
  std::vector<Cell> expected_path;
  /// With SearchDetail::kTree; of several trees the one that visited the chosen action most.
  std::vector<ReportedNode> tree;
  std::vector<ReportedView> views;
};

}  // namespace conav::planner
