#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "common/grid/grid.h"

// One user: region_graph; the partition is the geometry, the graph what the search sees of it.

namespace conav {
class ConfigReader;
}

namespace conav::planner {

/// How a raster is cut into regions, and what of it a robot can cross. Lengths are in cells of the
/// raster.
struct RegionOptions {
  /// Traversable cells that one seed stands for; 90 gives 250 seeds on 150 x 150 (A39).
  double cells_per_seed = 90.0;
  /// Share of the seeds that lie near obstacles, where a part of the map holds both such cells and
  /// others, and what near is.
  double boundary_share = 0.4;
  double boundary_distance_cells = 4.0;
  /// The robot's radius: a cell is not traversable if the centre of an occupied one is closer.
  double clearance_cells = 0.0;
  /// A move of this length costs one step (Edge::length).
  double step_length_cells = 10.0;

  void Visit(ConfigReader& reader);
  bool operator==(const RegionOptions&) const = default;
};

/// Cuts the traversable cells of a raster into regions: each cell belongs to the seed that is
/// nearest by 4-connected steps through traversable cells, of equals to the one with the smaller
/// index, so no region leaks through a wall. Traversable are free and unknown cells, but for unknown
/// ones of the outermost ring, that are not within the robot's clearance of an occupied one.
///
/// Seeds depend on the map nearby alone: the map is cut into square tiles of about ten seeds; a tile
/// takes its number of seeds in the order of a low-discrepancy sequence of its own (R2: M. Roberts,
/// "The unreasonable effectiveness of quasirandom sequences", 2018), and each 4-connected piece of a
/// tile's traversable cells has a seed at least, so no passage is without.
///
/// Update() does work only where the map changed: it seeds the tiles that changed, takes away the
/// regions that lost their seed or a cell, and grows the others into what is open (a dynamic
/// shortest-path forest: Ramalingam and Reps, "An incremental algorithm for a generalization of the
/// shortest-path problem", J. Algorithms 21, 1996, by whole regions). The result depends on the
/// newest map alone.
///
/// A cell is named by its index, row-major; a region by the index of its seed.
class RegionPartition {
 public:
  static constexpr int kNone = -1;

  /// What an update changed, ascending.
  struct Changes {
    std::vector<int> regions;  // with other cells than before, new or gone
    std::vector<int> borders;  // these, and all that lie next to a cell that changed its region
  };

  /// Lengths are finite and at least 0, those of a seed and a step above 0.
  explicit RegionPartition(const RegionOptions& options);

  const Changes& Update(const OccupancyGrid& known);

  const OccupancyGrid& known() const { return known_; }
  bool IsTraversable(Cell cell) const {
    return known_.Contains(cell) && traversable_[known_.IndexOf(cell)] != 0;
  }
  /// The region of a cell, kNone where it is not traversable.
  int RegionOf(int index) const { return RegionIn(keys_[At(index)]); }
  bool IsSeed(int index) const { return keys_[At(index)] == KeyOf(0, index); }
  /// Indices of the cells of region `seed`, ascending.
  std::vector<int> CellsOf(int seed);
  /// All seeds, ascending.
  std::vector<int> Seeds() const;
  /// Whether the newest update changed what is known of a cell, or whether it is traversable, in a
  /// part of the map that the rectangle between these corners overlaps.
  bool ChangedNear(Cell north_west, Cell south_east) const;
  /// Calls `visit` with the index of each of the up to four neighbours of a cell, in the order of
  /// kNeighbourOffsets.
  template <class Visit>
  void ForNeighbours(int index, Visit&& visit) const {
    const Cell cell = known_.CellAt(At(index));
    if (cell.row > 0) visit(index - known_.columns());
    if (cell.column + 1 < known_.columns()) visit(index + 1);
    if (cell.row + 1 < known_.rows()) visit(index + known_.columns());
    if (cell.column > 0) visit(index - 1);
  }

 private:
  /// Steps to the seed in the upper half, the seed in the lower: the smaller key wins a cell.
  using Key = std::uint64_t;
  static constexpr Key kNoKey = std::numeric_limits<Key>::max();
  static Key KeyOf(int steps, int seed) {
    return static_cast<Key>(steps) << 32 | static_cast<std::uint32_t>(seed);
  }
  static int RegionIn(Key key) {
    return key == kNoKey ? kNone : static_cast<int>(key & 0xffffffffU);
  }
  static int StepsIn(Key key) { return static_cast<int>(key >> 32); }
  static std::size_t At(int number) { return static_cast<std::size_t>(number); }

  struct Tile {
    bool changed = false;  // what is known of its cells, or whether they are traversable
    bool needs_seeds = true;
    std::vector<int> seeds;  // ascending
  };
  struct Rectangle {
    int first_row, end_row, first_column, end_column;
  };
  /// A cell that the update touched, and its region before.
  struct Touched {
    int index;
    int region;
  };

  void Reset(int rows, int columns);
  void ReadMap(const OccupancyGrid& known);
  void CountObstacle(Cell cell, int by);
  void DecideTraversable();
  bool MayCross(int index) const;
  void PlaceSeeds();
  std::vector<int> SeedsOf(int tile);
  void DrawSeeds(int tile, std::vector<int>& seeds);
  void AddSeedsOfPieces(int tile, std::vector<int>& seeds);
  std::vector<int> TakePiece(int start, const Rectangle& within);
  void TakeAway(int seed);
  void OpenNeighboursOf(int index);
  void Grow();
  void CollectChanges();
  void SetKey(int index, Key key);
  void Push(int index);

  Rectangle RectangleOf(int tile) const;
  int TileOf(Cell cell) const {
    return cell.row / tile_side_ * tile_columns_ + cell.column / tile_side_;
  }
  int IndexOf(Cell cell) const { return static_cast<int>(known_.IndexOf(cell)); }

  RegionOptions options_;
  int tile_side_;
  std::vector<Cell> blocked_disc_;  // offsets of the cells that an obstacle blocks
  std::vector<Cell> near_disc_;     // and of those that it is near to

  OccupancyGrid known_;
  std::vector<std::uint16_t> blocked_by_;  // by cell: obstacles that block it
  std::vector<std::uint16_t> near_to_;     // by cell: obstacles that it is near to
  std::vector<std::uint8_t> traversable_;  // by cell
  std::vector<Key> keys_;                  // by cell
  int tile_columns_ = 0;
  std::vector<Tile> tiles_;

  // Of one update.
  std::vector<int> recheck_;  // cells that may have become traversable, or no longer be
  std::vector<int> opened_;
  std::vector<int> lost_;  // regions that lost their seed or a cell
  std::vector<Touched> touched_;
  std::vector<std::uint8_t> is_touched_;    // by cell
  std::vector<std::uint8_t> mark_;          // by cell: scratch, all 0 between calls
  std::vector<std::vector<int>> frontier_;  // cells by steps to the seed
  Changes changes_;
};

}  // namespace conav::planner
