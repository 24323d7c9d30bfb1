#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "common/grid/visibility.h"
#include "common/msg/planning.h"

namespace conav::planner {

/// Number of a vertex: 0 .. vertex_count() - 1.
using VertexId = int;

/// A connection from one vertex to another that is not known to be blocked.
struct Edge {
  VertexId target = 0;
  /// Probability that the move succeeds: 1 known free, 0.5 unknown. Source: paper section 5.2.
  double feasibility = 1.0;
  /// Edges with the same id are free or blocked together (in a maze the id stands for the cell that
  /// they enter). Below uncertainty_count().
  int uncertainty = 0;
  bool operator==(const Edge&) const = default;
};

/// Where a robot can go and what it could show from there, to the robot's knowledge. The search sees
/// nothing else of the world, so a maze and a waterway are just two graphs for the same search.
/// The knowledge is fixed: a graph is valid for one decision.
/// Threads: safe to use concurrently.
class NavigationGraph {
 public:
  virtual ~NavigationGraph() = default;

  virtual int vertex_count() const = 0;
  virtual int uncertainty_count() const = 0;
  /// The cell of the operator's map in which the vertex lies.
  virtual Cell CellOf(VertexId vertex) const = 0;
  /// The vertex that stands for `cell`; nothing where the robot cannot be.
  virtual std::optional<VertexId> VertexAt(Cell cell) const = 0;
  /// Moves, in a fixed order.
  virtual std::span<const Edge> EdgesFrom(VertexId vertex) const = 0;
  /// Headings of the views that can be sent from here, in a fixed order, in radians.
  virtual std::span<const double> HeadingsAt(VertexId vertex) const = 0;
  /// What view `index` of HeadingsAt() would show. Valid as long as the graph.
  virtual const VisibleCells& ViewFrom(VertexId vertex, int index) const = 0;
};

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
  /// x_0: probability that the operator believes a cell to be a wall.
  const BeliefGrid& belief;
  /// Multiplies a view's expected edits, in [0, 1]: the share of the expected edits that the operator
  /// makes (OperatorReliability). 1 in the paper.
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

/// The actions that each vertex offers during one decision, contiguous in memory because the
/// innermost loop of the search reads them.
class OfferedActions {
 public:
  explicit OfferedActions(const SearchProblem& problem);

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
  };

  void AddViews(const SearchProblem& problem, VertexId vertex);

  std::vector<First> first_;  // one more than vertices
  std::vector<Edge> edges_;
  std::vector<int> views_;
};

}  // namespace conav::planner
