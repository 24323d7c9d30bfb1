#pragma once

#include <span>
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

/// Which actions each vertex offers during one decision, side by side in memory: the innermost loop
/// of the search reads it.
class OfferedActions {
 public:
  explicit OfferedActions(const SearchProblem& problem);

  bool operator==(const OfferedActions&) const = default;

  /// The moves of vertex 0, of vertex 1, ...
  std::span<const Edge> edges() const { return edges_; }

  Actions At(VertexId vertex) const {
    const First& from = first_[static_cast<std::size_t>(vertex)];
    const First& to = first_[static_cast<std::size_t>(vertex) + 1];
    return {{edges_.data() + from.edge, edges_.data() + to.edge},
            {views_.data() + from.view, views_.data() + to.view}};
  }

 private:
  /// Where the edges and views of a vertex begin.
  struct First {
    std::size_t edge = 0;
    std::size_t view = 0;
    bool operator==(const First&) const = default;
  };

  void AddViews(const SearchProblem& problem, VertexId vertex);

  std::vector<First> first_;  // one more than vertices
  std::vector<Edge> edges_;
  std::vector<int> views_;
};

}  // namespace conav::planner
