#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <vector>

#include "common/grid/grid.h"
#include "common/grid/visibility.h"
#include "planner/search/search_problem.h"

namespace conav::planner {

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
    bool operator==(const Options&) const = default;
  };

  explicit GridViews(const Options& options);

  const Options& options() const { return options_; }
  std::span<const double> headings() const { return headings_; }
  /// What heading number `index` shows from `cell`, as far as `known` tells.
  VisibleCells Cast(const OccupancyGrid& known, Cell cell, int index) const {
    return casters_[static_cast<std::size_t>(index)].Cast(known, cell);
  }

 private:
  Options options_;
  std::vector<double> headings_;
  std::vector<ViewCaster> casters_;  // by heading
};

/// The navigation graph of a maze, from what one robot has mapped: a vertex per cell that is not
/// known to be a wall, moves north, east, south, west, views at evenly spaced headings from the
/// cell's centre, cast on the known map (an unknown cell ends the ray unseen: the robot cannot
/// promise what it has not mapped). Views are computed on first use and kept.
class GridGraph final : public NavigationGraph {
 public:
  struct Options {
    /// Feasibility of entering a cell that was not seen yet.
    double unknown_feasibility = 0.5;
    /// The outermost ring holds walls even where it was not seen yet.
    bool border_is_wall = true;
  };

  /// `occupied_now`: cells that must not be entered at present, for example because other robots
  /// stand there.
  GridGraph(OccupancyGrid known, std::span<const Cell> occupied_now,
            std::shared_ptr<const GridViews> views, const Options& options);
  /// With the simulated camera in eight directions.
  GridGraph(OccupancyGrid known, std::span<const Cell> occupied_now);

  int vertex_count() const override { return static_cast<int>(known_.size()); }
  int uncertainty_count() const override { return vertex_count(); }
  Cell CellOf(VertexId vertex) const override;
  std::optional<VertexId> VertexAt(Cell cell) const override;
  std::span<const Edge> EdgesFrom(VertexId vertex) const override;
  std::span<const double> HeadingsAt(VertexId vertex) const override;
  const VisibleCells& ViewFrom(VertexId vertex, int index) const override;

 private:
  bool MayBeFree(Cell cell) const;
  void AddEdges(Cell from, const Grid<std::uint8_t>& occupied);

  OccupancyGrid known_;
  std::shared_ptr<const GridViews> camera_;
  Options options_;
  std::vector<Edge> edges_;              // of vertex 0, of vertex 1, ...
  std::vector<std::size_t> first_edge_;  // vertex v has edges_[first_edge_[v], first_edge_[v + 1])
  mutable std::mutex mutex_;             // guards views_ while they are filled in
  mutable std::vector<std::optional<VisibleCells>> views_;  // vertex * headings + index
};

}  // namespace conav::planner
