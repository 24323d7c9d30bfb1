#pragma once

#include <optional>
#include <vector>

#include "planner/search/search_problem.h"

namespace conav::planner {

/// The actions at a vertex, numbered: moves first, then views. Walls and cells occupied by others
/// are not in the graph, so they are not offered (A9); neither are views that were sent already
/// (A30).
struct Actions {
  std::span<const Edge> moves;
  std::span<const int> views;  // indices into NavigationGraph::HeadingsAt()

  int size() const { return static_cast<int>(moves.size() + views.size()); }
  bool IsMove(int action) const { return action < static_cast<int>(moves.size()); }
  const Edge& MoveOf(int action) const { return moves[static_cast<std::size_t>(action)]; }
  /// Position in `views` of a communication action.
  std::size_t ViewOf(int action) const { return static_cast<std::size_t>(action) - moves.size(); }
};

/// Works out, and remembers, which actions a vertex offers during one decision.
class OfferedActions {
 public:
  /// `problem` must outlive this.
  explicit OfferedActions(const SearchProblem& problem);

  Actions At(VertexId vertex);

 private:
  std::vector<int> OfferedViews(VertexId vertex) const;

  const SearchProblem& problem_;
  std::vector<std::optional<std::vector<int>>> views_;  // by vertex
};

}  // namespace conav::planner
