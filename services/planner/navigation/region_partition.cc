#include "planner/navigation/region_partition.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/runtime/config.h"
#include "common/runtime/result.h"

namespace conav::planner {
namespace {

constexpr double kSeedsOfTile = 10.0;
/// Draws of the sequence for each cell of a tile: hardly a cell is left out.
constexpr int kDrawsPerCell = 4;

/// SplitMix64's finaliser: a number that looks random.
std::uint64_t Scramble(std::uint64_t value) {
  value += 0x9e3779b97f4a7c15ULL;
  value = (value ^ (value >> 30)) * 0xbf58476d1ce4e5b9ULL;
  value = (value ^ (value >> 27)) * 0x94d049bb133111ebULL;
  return value ^ (value >> 31);
}

/// The R2 sequence in fixed point, 2^32 to the side, from a start of its own for each tile.
class Sequence {
 public:
  explicit Sequence(std::uint64_t start)
      : x_(static_cast<std::uint32_t>(start)), y_(static_cast<std::uint32_t>(start >> 32)) {}

  /// The next cell of a square of `side`.
  Cell Next(int side) {
    x_ += 3242174889U;  // 2^32 / p, where p^3 = p + 1
    y_ += 2447445414U;  // 2^32 / p^2
    const auto scaled = [side](std::uint32_t value) {
      return static_cast<int>(value * static_cast<std::uint64_t>(side) >> 32);
    };
    return {scaled(y_), scaled(x_)};
  }

 private:
  std::uint32_t x_;
  std::uint32_t y_;
};

/// Offsets closer than `radius`, or just as far if `closed`; (0, 0) always.
std::vector<Cell> Disc(double radius, bool closed) {
  std::vector<Cell> offsets;
  const int reach = static_cast<int>(std::ceil(radius));
  for (int row = -reach; row <= reach; ++row) {
    for (int column = -reach; column <= reach; ++column) {
      const double squared = row * row + column * column;
      const bool within = squared < radius * radius || (closed && squared == radius * radius);
      if (within || squared == 0.0) offsets.push_back({row, column});
    }
  }
  return offsets;
}

void SortUnique(std::vector<int>& numbers) {
  std::sort(numbers.begin(), numbers.end());
  numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
}

}  // namespace

void RegionOptions::Visit(ConfigReader& reader) {
  reader.Field("cells_per_seed", cells_per_seed, 1.0, 1e6);
  reader.Field("boundary_share", boundary_share, 0.0, 1.0);
  reader.Field("boundary_distance_cells", boundary_distance_cells, 0.0, 100.0);
  reader.Field("clearance_cells", clearance_cells, 0.0, 100.0);
  reader.Field("step_length_cells", step_length_cells, 1e-3, 1e6);
}

RegionPartition::RegionPartition(const RegionOptions& options)
    : options_(options),
      tile_side_(static_cast<int>(std::ceil(std::sqrt(kSeedsOfTile * options.cells_per_seed)))),
      blocked_disc_(Disc(options.clearance_cells, false)),
      near_disc_(Disc(options.clearance_cells + options.boundary_distance_cells, true)) {
  DEMAND(options.cells_per_seed > 0.0 && options.step_length_cells > 0.0, options.cells_per_seed,
         options.step_length_cells);
}

const RegionPartition::Changes& RegionPartition::Update(const OccupancyGrid& known) {
  const bool other_size = known.rows() != known_.rows() || known.columns() != known_.columns();
  if (other_size) Reset(known.rows(), known.columns());
  for (Tile& tile : tiles_) tile.changed = other_size;
  ReadMap(known);
  DecideTraversable();
  PlaceSeeds();
  SortUnique(lost_);
  for (const int seed : lost_) TakeAway(seed);
  for (const int index : opened_) OpenNeighboursOf(index);
  Grow();
  CollectChanges();
  return changes_;
}

/// A map of this size of which nothing is known yet, and no cell has been looked at.
void RegionPartition::Reset(int rows, int columns) {
  known_ = OccupancyGrid(rows, columns, Occupancy::kUnknown);
  blocked_by_.assign(known_.size(), 0);
  near_to_.assign(known_.size(), 0);
  traversable_.assign(known_.size(), 0);
  keys_.assign(known_.size(), kNoKey);
  is_touched_.assign(known_.size(), 0);
  mark_.assign(known_.size(), 0);
  tile_columns_ = (columns + tile_side_ - 1) / tile_side_;
  tiles_.assign(At(tile_columns_) * At((rows + tile_side_ - 1) / tile_side_), {});
  for (std::size_t i = 0; i < known_.size(); ++i) recheck_.push_back(static_cast<int>(i));
}

void RegionPartition::ReadMap(const OccupancyGrid& known) {
  for (std::size_t i = 0; i < known.size(); ++i) {
    const Occupancy before = known_.values()[i];
    const Occupancy now = known.values()[i];
    if (before == now) continue;
    known_.values()[i] = now;
    const Cell cell = known_.CellAt(i);
    tiles_[At(TileOf(cell))].changed = true;
    recheck_.push_back(static_cast<int>(i));
    if (now == Occupancy::kOccupied) CountObstacle(cell, 1);
    if (before == Occupancy::kOccupied) CountObstacle(cell, -1);
  }
}

void RegionPartition::CountObstacle(Cell cell, int by) {
  const auto add = [&](std::uint16_t& count) {
    const std::uint16_t before = count;
    count = static_cast<std::uint16_t>(count + by);
    return before == 0 || count == 0;
  };
  for (const Cell offset : blocked_disc_) {
    const Cell other = cell + offset;
    if (!known_.Contains(other)) continue;
    const std::size_t index = known_.IndexOf(other);
    if (add(blocked_by_[index])) recheck_.push_back(static_cast<int>(index));
  }
  for (const Cell offset : near_disc_) {
    const Cell other = cell + offset;
    if (!known_.Contains(other)) continue;
    if (add(near_to_[known_.IndexOf(other)])) tiles_[At(TileOf(other))].needs_seeds = true;
  }
}

bool RegionPartition::MayCross(int index) const {
  if (blocked_by_[At(index)] > 0) return false;
  return known_.values()[At(index)] != Occupancy::kUnknown ||
         !known_.OnBorder(known_.CellAt(At(index)));
}

void RegionPartition::DecideTraversable() {
  opened_.clear();
  lost_.clear();
  for (const int index : recheck_) {
    const std::uint8_t now = MayCross(index) ? 1 : 0;
    if (traversable_[At(index)] == now) continue;
    traversable_[At(index)] = now;
    Tile& tile = tiles_[At(TileOf(known_.CellAt(At(index))))];
    tile.needs_seeds = tile.changed = true;
    if (now != 0) {
      opened_.push_back(index);
    } else if (keys_[At(index)] != kNoKey) {
      lost_.push_back(RegionOf(index));
    }
  }
  recheck_.clear();
}

RegionPartition::Rectangle RegionPartition::RectangleOf(int tile) const {
  const int row = tile / tile_columns_ * tile_side_;
  const int column = tile % tile_columns_ * tile_side_;
  return {row, std::min(row + tile_side_, known_.rows()), column,
          std::min(column + tile_side_, known_.columns())};
}

void RegionPartition::PlaceSeeds() {
  for (int number = 0; number < static_cast<int>(tiles_.size()); ++number) {
    Tile& tile = tiles_[At(number)];
    if (!tile.needs_seeds) continue;
    tile.needs_seeds = false;
    std::vector<int> seeds = SeedsOf(number);
    std::set_difference(tile.seeds.begin(), tile.seeds.end(), seeds.begin(), seeds.end(),
                        std::back_inserter(lost_));
    tile.seeds = std::move(seeds);
  }
}

std::vector<int> RegionPartition::SeedsOf(int tile) {
  std::vector<int> seeds;
  DrawSeeds(tile, seeds);
  AddSeedsOfPieces(tile, seeds);
  SortUnique(seeds);
  return seeds;
}

void RegionPartition::DrawSeeds(int tile, std::vector<int>& seeds) {
  const Rectangle area = RectangleOf(tile);
  int near = 0;
  int open = 0;
  for (int row = area.first_row; row < area.end_row; ++row) {
    for (int column = area.first_column; column < area.end_column; ++column) {
      const std::size_t index = known_.IndexOf({row, column});
      if (traversable_[index] == 0) continue;
      ++(near_to_[index] > 0 ? near : open);
    }
  }
  const std::uint64_t random = Scramble(static_cast<std::uint64_t>(tile));
  // Rounded up or down at random, so that the sum over the tiles is right.
  const double dither = static_cast<double>(random >> 40) * 0x1p-24;
  const int count = static_cast<int>((near + open) / options_.cells_per_seed + dither);
  const double share = near == 0 ? 0.0 : open == 0 ? 1.0 : options_.boundary_share;
  int near_left = static_cast<int>(std::lround(share * count));
  int open_left = count - near_left;
  Sequence sequence(Scramble(random));
  const double apart = options_.cells_per_seed / 4.0;  // squared: half a region's width
  for (int i = kDrawsPerCell * tile_side_ * tile_side_; i > 0 && near_left + open_left > 0; --i) {
    const Cell cell = sequence.Next(tile_side_) + Cell{area.first_row, area.first_column};
    if (!IsTraversable(cell)) continue;
    const int index = IndexOf(cell);
    int& left = near_to_[At(index)] > 0 ? near_left : open_left;
    const bool is_close = std::any_of(seeds.begin(), seeds.end(), [&](int seed) {
      const Cell way = known_.CellAt(At(seed)) - cell;
      return way.row * way.row + way.column * way.column < apart;
    });
    if (left == 0 || is_close) continue;
    --left;
    seeds.push_back(index);
  }
}

/// Where no seed was drawn in a piece of the tile, the middle one of its cells becomes one.
void RegionPartition::AddSeedsOfPieces(int tile, std::vector<int>& seeds) {
  const Rectangle area = RectangleOf(tile);
  for (const int seed : seeds) TakePiece(seed, area);
  for (int row = area.first_row; row < area.end_row; ++row) {
    for (int column = area.first_column; column < area.end_column; ++column) {
      std::vector<int> piece = TakePiece(IndexOf({row, column}), area);
      if (piece.empty()) continue;
      const auto middle = piece.begin() + static_cast<std::ptrdiff_t>(piece.size() / 2);
      std::nth_element(piece.begin(), middle, piece.end());
      seeds.push_back(*middle);
    }
  }
  for (int row = area.first_row; row < area.end_row; ++row) {
    const auto first = mark_.begin() + IndexOf({row, area.first_column});
    std::fill(first, first + (area.end_column - area.first_column), std::uint8_t{0});
  }
}

/// Marks the traversable cells that are connected with `start` inside the rectangle and returns
/// them; none if it is marked already.
std::vector<int> RegionPartition::TakePiece(int start, const Rectangle& within) {
  std::vector<int> piece;
  const auto take = [&](int index) {
    if (traversable_[At(index)] == 0 || mark_[At(index)] != 0) return;
    mark_[At(index)] = 1;
    piece.push_back(index);
  };
  take(start);
  for (std::size_t i = 0; i < piece.size(); ++i) {
    ForNeighbours(piece[i], [&](int index) {
      const Cell cell = known_.CellAt(At(index));
      if (cell.row < within.first_row || cell.row >= within.end_row) return;
      if (cell.column < within.first_column || cell.column >= within.end_column) return;
      take(index);
    });
  }
  return piece;
}

void RegionPartition::SetKey(int index, Key key) {
  if (is_touched_[At(index)] == 0) {
    is_touched_[At(index)] = 1;
    touched_.push_back({index, RegionOf(index)});
  }
  keys_[At(index)] = key;
}

void RegionPartition::Push(int index) {
  const std::size_t steps = At(StepsIn(keys_[At(index)]));
  if (frontier_.size() <= steps) frontier_.resize(steps + 1);
  frontier_[steps].push_back(index);
}

/// The whole region, as ways to the seed may have led through a cell that is lost. Those of other
/// regions lie in their own.
void RegionPartition::TakeAway(int seed) {
  std::vector<int> cells{seed};
  SetKey(seed, kNoKey);
  for (std::size_t i = 0; i < cells.size(); ++i) {
    ForNeighbours(cells[i], [&](int index) {
      if (RegionOf(index) != seed) return;
      SetKey(index, kNoKey);
      cells.push_back(index);
    });
  }
  for (const int index : cells) {
    if (traversable_[At(index)] != 0) opened_.push_back(index);
  }
}

void RegionPartition::OpenNeighboursOf(int index) {
  ForNeighbours(index, [&](int neighbour) {
    if (keys_[At(neighbour)] != kNoKey) Push(neighbour);
  });
}

/// From seeds that are new and from regions next to what is open, nearest cells first.
void RegionPartition::Grow() {
  for (const Tile& tile : tiles_) {
    for (const int seed : tile.seeds) {
      if (IsSeed(seed)) continue;
      SetKey(seed, KeyOf(0, seed));
      Push(seed);
    }
  }
  for (std::size_t steps = 0; steps < frontier_.size(); ++steps) {
    for (std::size_t i = 0; i < frontier_[steps].size(); ++i) {
      const Key key = keys_[At(frontier_[steps][i])];
      if (At(StepsIn(key)) != steps) continue;  // a shorter way was found
      const Key next = key + KeyOf(1, 0);
      ForNeighbours(frontier_[steps][i], [&](int index) {
        if (traversable_[At(index)] == 0 || keys_[At(index)] <= next) return;
        SetKey(index, next);
        Push(index);
      });
    }
    frontier_[steps].clear();
  }
}

void RegionPartition::CollectChanges() {
  changes_.regions.clear();
  changes_.borders.clear();
  const auto add = [](int region, std::vector<int>& to) {
    if (region != kNone && (to.empty() || to.back() != region)) to.push_back(region);
  };
  for (const Touched& touched : touched_) {
    is_touched_[At(touched.index)] = 0;
    const int now = RegionOf(touched.index);
    if (now == touched.region) continue;
    add(touched.region, changes_.regions);
    add(now, changes_.regions);
    ForNeighbours(touched.index, [&](int index) { add(RegionOf(index), changes_.borders); });
  }
  touched_.clear();
  SortUnique(changes_.regions);
  changes_.borders.insert(changes_.borders.end(), changes_.regions.begin(), changes_.regions.end());
  SortUnique(changes_.borders);
}

std::vector<int> RegionPartition::CellsOf(int seed) {
  std::vector<int> cells{seed};
  mark_[At(seed)] = 1;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    ForNeighbours(cells[i], [&](int index) {
      if (RegionOf(index) != seed || mark_[At(index)] != 0) return;
      mark_[At(index)] = 1;
      cells.push_back(index);
    });
  }
  for (const int index : cells) mark_[At(index)] = 0;
  std::sort(cells.begin(), cells.end());
  return cells;
}

std::vector<int> RegionPartition::Seeds() const {
  std::vector<int> seeds;
  for (const Tile& tile : tiles_) seeds.insert(seeds.end(), tile.seeds.begin(), tile.seeds.end());
  std::sort(seeds.begin(), seeds.end());
  return seeds;
}

bool RegionPartition::ChangedNear(Cell north_west, Cell south_east) const {
  const int first = TileOf(north_west);
  const int last = TileOf(south_east);
  const int width = last % tile_columns_ - first % tile_columns_;
  for (int row = first - first % tile_columns_; row <= last; row += tile_columns_) {
    for (int column = 0; column <= width; ++column) {
      if (tiles_[At(row + first % tile_columns_ + column)].changed) return true;
    }
  }
  return false;
}

}  // namespace conav::planner
