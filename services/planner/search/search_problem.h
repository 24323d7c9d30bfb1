#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "common/grid/grid.h"
#include "common/grid/visibility.h"
#include "common/msg/perception_model.h"
#include "common/msg/search_report.h"
#include "planner/search/on_demand.h"

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
  /// In steps: what the move costs, and what it counts for on the way to a goal.
  double length = 1.0;
  bool operator==(const Edge&) const = default;
};

/// Expected numbers of steps to the nearest of some goals, from the vertices of a graph: an edge
/// counts as its length / feasibility, times what SearchProblem says of it. Where no goal can be reached the number is that of the
/// farthest vertex plus one, 0 if there is none.
class StepsToGoals {
 public:
  virtual ~StepsToGoals() = default;
  virtual double From(VertexId vertex) = 0;
};

struct SearchProblem;

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
  /// All cells of the map that the vertex stands for, that one included: what a robot that was there
  /// has been to, as the perception model sees it. Valid as long as the graph.
  virtual std::span<const Cell> CellsOf(VertexId vertex) const = 0;
  /// The vertex that stands for `cell`; nothing where the robot cannot be.
  virtual std::optional<VertexId> VertexAt(Cell cell) const = 0;
  /// Moves, in a fixed order.
  virtual std::span<const Edge> EdgesFrom(VertexId vertex) const = 0;
  /// Headings of the views that can be sent from here, in a fixed order, in radians.
  virtual std::span<const double> HeadingsAt(VertexId vertex) const = 0;
  /// What view `index` of HeadingsAt() would show. Valid as long as the graph.
  virtual const VisibleCells& ViewFrom(VertexId vertex, int index) const = 0;
  /// To `goals` as steps count in `problem`, which is on this graph. Valid as long as both; for one
  /// thread. By default all vertices are worked out at once.
  virtual std::unique_ptr<StepsToGoals> StepsTo(const SearchProblem& problem,
                                                std::vector<VertexId> goals) const;
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
  /// tau_0: cells since the last picture, the present one last (added if it is missing). Cells of one
  /// vertex that follow each other are one state.
  std::vector<Cell> path;
  std::vector<Cell> goals_left;
  /// zeta: the operator's path; may be empty.
  std::vector<Cell> guidance;
  /// Whether the operator has ever given this robot a path: without one there is no penalty for
  /// being off it, with one that was withdrawn there is (docs/paper.md A16).
  bool guided_before = false;
  /// x_0: probability that the operator believes a cell to be a wall.
  SharedBelief belief;
  /// Multiplies a view's expected edits, in [0, 1]: the share of the expected edits that the operator
  /// makes (OperatorReliability). 1 in the paper.
  double information_weight = 1.0;
  /// Views that are not offered, because they were sent and nothing changed since.
  std::vector<SentView> sent_views;
  /// How often a step that may fail counts on the way to the nearest goal (ProgressReward) if the
  /// operator's map has nothing but walls where it leads, by their share there: where the robot has not
  /// looked yet, the operator's map is what there is. 1: as often as any other.
  int believed_wall_steps = 1;
  /// How often a step off the operator's path counts on the way to the nearest goal. More than 1: that
  /// way is the operator's, and from elsewhere the one back to it.
  int off_guidance_steps = 1;
  /// Views that cannot show enough and count as worth nothing: the model is not asked about them. By
  /// vertex, then index of NavigationGraph::HeadingsAt(), 1 = such a view; empty = there are none.
  std::vector<std::uint8_t> poor_views;
  /// Where somebody else has to find goals in pictures: how likely each cell still hides one, relative to
  /// the others, and what it is worth to show a cell of likelihood 1, in expected edits; an empty grid =
  /// goals are known. A view is worth its expected edits and these. An addition to the paper.
  Grid<float> hidden;
  double hidden_value = 0.0;
  /// What any picture is worth beside that, in expected edits, because its answer shows the robot a way
  /// that it lacks. An addition to the paper, whose robot always knows where to go.
  double answer_value = 0.0;
};

/// The worth of the cells with hidden goals in what a view shows.
double HiddenWorth(const SearchProblem& problem, const VisibleCells& visible);

/// What a search reports: its root actions in their fixed order, moves, then views (those never
/// tried have 0 visits); `chosen` is -1 when nothing can be done, or no goal is left; of several
/// trees `tree` is the one that visited the chosen action most. Whose decision it is, and when, the
/// worker fills in.
struct SearchResult : SearchReport {
  std::uint32_t perception_calls = 0;  // batches that the queries were asked in
  /// Cells entered along the most visited actions, nearest first; ends where that line sends a
  /// picture, reaches a goal or was not searched further.
  std::vector<Cell> expected_path;
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

/// The actions that each vertex offers during one decision, worked out when they are asked for
/// first. Threads: one at a time.
class OfferedActions {
 public:
  /// `problem` must outlive this.
  explicit OfferedActions(const SearchProblem& problem);

  /// Valid as long as this.
  const Actions& At(VertexId vertex) {
    Offered& offered = offered_[static_cast<std::size_t>(vertex)];
    if (!offered.is_known) [[unlikely]] {
      LookUp(vertex, offered);
    }
    return offered.actions;
  }

 private:
  struct Offered {
    Actions actions;
    std::vector<int> views;
    bool is_known = false;
  };

  void LookUp(VertexId vertex, Offered& offered);

  const SearchProblem& problem_;
  std::vector<std::pair<VertexId, double>> sent_;  // views that are not offered, by vertex
  OnDemand<Offered> offered_;
};

/// What a robot's camera is and where it may look: kept from one decision to the next, as its rays
/// are costly to work out. Threads: safe to use concurrently.
class GridViews {
 public:
  struct Options {
    int headings = 8;
    /// The robot's camera, and what a cell is in metres.
    CameraLens lens;
    double cell_size_m = 2.0;
    /// Fewer than for a real picture; enough to meet nearly every cell that it shows.
    int rays = 256;
    /// How far a view reaches, from the camera.
    double range_cells = std::numeric_limits<double>::infinity();
    bool operator==(const Options&) const = default;
  };

  explicit GridViews(const Options& options);

  const Options& options() const { return options_; }
  std::span<const double> headings() const { return headings_; }
  /// What heading number `index` shows from `cell` by the map `known`.
  VisibleCells Cast(const OccupancyGrid& known, Cell cell, int index) const {
    return casters_[static_cast<std::size_t>(index)].Cast(known, cell);
  }

 private:
  Options options_;
  std::vector<double> headings_;
  std::vector<ViewCaster> casters_;  // by heading
};

class GridSteps;

/// The navigation graph of a maze, from what one robot has mapped: a vertex per cell that is not
/// known to be a wall, moves north, east, south, west, views at evenly spaced headings from the
/// cell's centre, cast on the known map (an unknown cell ends the ray unseen: the robot cannot
/// promise what it has not mapped). Edges and views are computed on first use and kept. The outermost ring holds
/// walls even where it was not seen yet.
class GridGraph final : public NavigationGraph {
 public:
  /// Feasibility of entering a cell that was not seen yet.
  static constexpr double kUnknownFeasibility = 0.5;

  /// `occupied_now`: cells that must not be entered at present, for example because other robots
  /// stand there. `steps`: of the robot's earlier graphs, which are no longer used; its own if none.
  GridGraph(OccupancyGrid known, std::span<const Cell> occupied_now,
            std::shared_ptr<const GridViews> views, std::shared_ptr<GridSteps> steps = nullptr);
  /// With the simulated camera in eight directions.
  GridGraph(OccupancyGrid known, std::span<const Cell> occupied_now);

  int vertex_count() const override { return static_cast<int>(known_.size()); }
  int uncertainty_count() const override { return vertex_count(); }
  Cell CellOf(VertexId vertex) const override;
  std::span<const Cell> CellsOf(VertexId vertex) const override;
  std::optional<VertexId> VertexAt(Cell cell) const override;
  std::span<const Edge> EdgesFrom(VertexId vertex) const override;
  std::span<const double> HeadingsAt(VertexId vertex) const override;
  const VisibleCells& ViewFrom(VertexId vertex, int index) const override;
  std::unique_ptr<StepsToGoals> StepsTo(const SearchProblem& problem,
                                        std::vector<VertexId> goals) const override;

 private:
  struct Vertex {
    bool is_made = false;
    Cell cell;
    std::vector<Edge> edges;
    std::vector<std::optional<VisibleCells>> views;  // by heading
  };

  bool MayBeFree(Cell cell) const;
  bool IsOccupied(Cell cell) const;
  /// Makes it when it is asked for first. Requires a lock of mutex_.
  Vertex& VertexLocked(VertexId vertex) const;
  std::vector<Edge> MakeEdges(Cell from) const;

  OccupancyGrid known_;
  std::vector<Cell> occupied_now_;  // sorted
  std::shared_ptr<const GridViews> camera_;
  std::shared_ptr<GridSteps> steps_;
  mutable std::mutex mutex_;  // guards vertices_ and *steps_
  mutable OnDemand<Vertex> vertices_;
};

}  // namespace conav::planner
