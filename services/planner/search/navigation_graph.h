#pragma once

#include <optional>
#include <span>

#include "common/grid/visibility.h"

namespace conav::planner {

/// Number of a vertex: 0 .. vertex_count() - 1.
using VertexId = int;

/// A way from one vertex to another that is not known to be blocked.
struct Edge {
  VertexId target = 0;
  /// Probability that the move succeeds: 1 known free, 0.5 unknown. Source: paper section 5.2.
  double feasibility = 1.0;
  /// What is uncertain about it: edges with the same id are free or blocked together (in a maze the
  /// cell that is entered). Below uncertainty_count().
  int uncertainty = 0;
  bool operator==(const Edge&) const = default;
};

/// Where a robot can go and what it could show from there, as far as the robot knows. The search
/// sees nothing else of the world, so mazes and waterways are two graphs to one search.
/// Knowledge is fixed: a graph stands for one decision.
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

}  // namespace conav::planner
