#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "planner/decision/method.h"
#include "planner/navigation/region_graph.h"

namespace conav::planner {

/// How one robot finds its way over a RegionGraph: the graph, kept from decision to decision, and the
/// places to drive along. A robot may have come within its clearance of an obstacle that it had not
/// seen before, where the graph has no vertex: then the nearest traversable cell stands for its own,
/// by steps through cells that are not known to be occupied. The same goes for goals and for cells of
/// the operator's path. Threads: one worker's.
class RegionNavigation {
 public:
  explicit RegionNavigation(const RegionOptions& options);

  /// What the next Update() would do, ahead of it: the robot has mapped something on its way.
  /// Does nothing before the first.
  void Prepare(const OccupancyGrid& map);
  /// Brings the graph up to the situation. `views` are those from its vertices.
  void Update(const Situation& situation, const std::shared_ptr<const GridViews>& views);

  // Of the newest update:

  const RegionGraph& graph() const { return *graph_; }
  /// Nothing where no traversable cell can be reached.
  std::optional<VertexId> VertexNear(Cell cell) const;
  /// `cells`, each replaced by the traversable one that stands for it, if there is one.
  std::vector<Cell> Traversable(std::vector<Cell> cells) const;
  /// The operator's path as the graph can follow it: its cells, each replaced by the traversable one
  /// that stands for it, and where it goes from one region into another without an edge between them,
  /// the vertices of the shortest way there, of at most kMostBridged. Nothing is added where it leads
  /// through cells that are known to be occupied.
  std::vector<Cell> FollowablePath(const std::vector<Cell>& path) const;
  static constexpr std::size_t kMostBridged = 3;

  /// Straight on to the nearest goal in the robot's own region; nothing if there is none.
  std::optional<Decision> ApproachGoal(const Situation& situation) const;
  /// Cells of the vertices to enter on the shortest way to a goal, where what was not seen counts as
  /// free; empty if there is none.
  std::vector<Cell> WayToGoal(const Situation& situation) const;
  /// The move into the region of the first of `vertices`, cells of vertices; decided without a search.
  /// The robot goes to the vertex itself unless a straighter way to the second leads through the
  /// region, over cells that were seen to be free.
  Decision MoveAlong(const Situation& situation, std::span<const Cell> vertices) const;
  /// The places to drive along to `target`, that last: straight there if no obstacle is near the
  /// line, else around corners of a shortest path. Empty if it cannot be reached.
  std::vector<Cell> RouteTo(const Situation& situation, Cell target) const;

 private:
  bool MayBeFree(Cell cell) const;
  std::optional<Cell> TraversableNear(Cell cell) const;
  Cell PlaceOnTheWay(Cell here, Cell vertex, Cell next) const;
  template <class Passable>
  bool IsClear(Cell from, Cell to, Passable&& passable) const;
  bool IsNearObstacle(Cell cell, Cell from, Cell to) const;
  template <class Passable>
  void AddCorners(Cell from, Cell to, Passable&& passable, std::vector<Cell>& route) const;

  RegionOptions options_;
  double body_cells_;  // between a line that is driven and the edges of occupied cells; 0 = no body
  double margin_cells_;  // without a body: between such a line and the centres of occupied cells
  std::shared_ptr<const GridViews> views_;
  std::optional<RegionGraph> graph_;
  std::vector<Cell> taken_;
};

}  // namespace conav::planner
