#pragma once

#include <compare>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <unordered_map>
#include <vector>

#include "planner/navigation/region_partition.h"
#include "planner/search/search_problem.h"

namespace conav::planner {

/// The navigation graph of a continuous world, from what one robot has mapped: a vertex per region of
/// a RegionPartition, at the region's cell nearest to its centroid (A38). Two regions that touch are
/// joined if the straight line between their vertices touches traversable cells only; feasibility is
/// 0.5 if it touches a cell that was not seen yet (A37). Edges go both ways, and both share an
/// uncertainty. Source: paper section 6.3.
///
/// The graph connects what the cells connect. Where two regions touch, and neither a line between
/// their vertices nor a third region joined to both connects them, vertices are added at the corners
/// of a shortest path inside the two; such a vertex takes the cells of its region that are nearer to
/// it than to the region's others. So a narrow passage is never lost.
///
/// Update() recomputes only what the map's changes can have changed, and gives the same graph as one
/// made from the new map alone. It may not run while a decision uses the graph, and ends the life of
/// everything that the graph returned. Vertices get new numbers each time. Views are cast on first
/// use, from the vertex's cell.
///
/// Cost:    on 150 x 150 cells about 3 ms to build and a tenth of that for an update, on 1000 x 1000
///          200 ms and 5 ms, of which most is numbering.
/// Threads: const methods are safe to use concurrently.
class RegionGraph final : public NavigationGraph {
 public:
  /// Feasibility of an edge that touches a cell that was not seen yet.
  static constexpr double kUnseenFeasibility = 0.5;

  /// Of an empty map, until the first Update().
  RegionGraph(const RegionOptions& options, std::shared_ptr<const GridViews> views);

  /// A map of another size starts from nothing. No edge leads to a vertex whose region holds one of
  /// the cells `taken`, where other robots are. Nothing happens if both are the same as before.
  void Update(const OccupancyGrid& known, std::span<const Cell> taken = {});

  const OccupancyGrid& known() const { return partition_.known(); }

  int vertex_count() const override { return static_cast<int>(vertices_.size()); }
  int uncertainty_count() const override { return uncertainty_count_; }
  Cell CellOf(VertexId vertex) const override { return vertices_[At(vertex)].cell; }
  /// The vertex's region, row-major; regions do not overlap.
  std::span<const Cell> CellsOf(VertexId vertex) const override {
    return vertices_[At(vertex)].cells;
  }
  std::optional<VertexId> VertexAt(Cell cell) const override;
  /// By target, ascending.
  std::span<const Edge> EdgesFrom(VertexId vertex) const override;
  std::span<const double> HeadingsAt(VertexId vertex) const override;
  const VisibleCells& ViewFrom(VertexId vertex, int index) const override;

 private:
  struct Region;
  /// A straight line between two cells, by index, that touches traversable cells only.
  struct Link {
    int from;
    int to;
    bool is_seen;
  };
  /// Two regions that touch, kept by the one with the smaller seed.
  struct Contact {
    int seed = 0;  // of the other
    Region* other = nullptr;
    bool is_new = true;
    bool is_clear = false;  // the line between the regions' cells touches traversable cells only
    bool is_seen = false;
    bool detour_known = false;
    std::vector<Link> detour;  // from the one to the other; once it was asked for
  };
  /// Cells of a region that are nearest to `node`: [first, end) of its cells.
  struct Part {
    int node;
    std::size_t first;
    std::size_t end;
  };
  struct Region {
    int seed = 0;
    int node = 0;  // index of the cell nearest to the centroid
    bool changed = true;
    Cell north_west;  // corners of the smallest rectangle around the cells
    Cell south_east;
    std::vector<Cell> cells;        // by part, then row-major
    std::vector<Part> parts;        // that of `node` first
    std::vector<Contact> contacts;  // by seed
    std::vector<int> joined;        // seeds of regions that a clear contact leads to, ascending
  };
  struct Vertex {
    Cell cell;
    std::span<const Cell> cells;
  };
  /// Vertices that are joined.
  struct Pair {
    VertexId smaller;
    VertexId larger;
    bool is_seen;
    auto operator<=>(const Pair&) const = default;
  };

  static std::size_t At(int number) { return static_cast<std::size_t>(number); }
  Cell CellAt(int index) const { return known().CellAt(At(index)); }
  int IndexOf(Cell cell) const { return static_cast<int>(known().IndexOf(cell)); }

  void MakeRegion(int seed);
  void FindContacts(Region& region);
  void JoinRegions();
  void Join(const Region& region, Contact& contact) const;
  std::optional<Link> LinkBetween(int from, int to) const;
  std::vector<Link> AddDetours();
  bool HasJoinedNeighbour(const Region& a, const Region& b) const;
  std::vector<Link> Detour(const Region& from, const Region& to) const;
  std::vector<int> ShortestPath(const Region& from, const Region& to) const;
  void SplitRegions(const std::vector<Link>& detours);
  void Split(Region& region, std::span<const int> nodes);
  void NumberVertices();
  std::vector<std::uint8_t> TakenVertices() const;
  void NumberEdges(const std::vector<Link>& detours);
  void FillEdges(std::span<const Pair> pairs);

  RegionPartition partition_;
  std::shared_ptr<const GridViews> camera_;
  double step_length_cells_;
  std::vector<Cell> taken_;
  std::map<int, Region> regions_;  // by seed
  std::vector<Region*> in_order_;  // the same
  std::vector<int> part_of_;       // by cell: the node of its part, where it is traversable
  std::vector<VertexId> number_;   // by cell: of the vertex there, where it is a node
  std::vector<Vertex> vertices_;
  std::vector<Edge> edges_;              // of vertex 0, of vertex 1, ...
  std::vector<std::size_t> first_edge_;  // vertex v has edges_[first_edge_[v], first_edge_[v + 1])
  int uncertainty_count_ = 0;
  mutable std::mutex mutex_;  // guards views_ while they are filled in
  mutable std::unordered_map<std::size_t, VisibleCells> views_;  // by vertex * headings + index
};

}  // namespace conav::planner
