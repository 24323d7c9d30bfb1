#include "sim/world/terrain.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "common/runtime/random.h"
#include "sim/world/clearance.h"

namespace conav::sim {
namespace {

using Field = Grid<std::int64_t>;

constexpr std::int64_t kMetre = 1024;  // heights in 1/1024 m
constexpr int kMostDraws = 200;

// Stage 1: smooth noise.

/// Means over windows of 2 radius + 1 values along each row, and then of each column.
Field Blurred(const Field& field, int radius) {
  Field across(field.columns(), field.rows());
  for (int row = 0; row < field.rows(); ++row) {
    std::int64_t sum = 0;
    for (int column = 0; column < field.columns() + radius; ++column) {
      if (column < field.columns()) sum += field[{row, column}];
      const int middle = column - radius;
      if (middle < 0) continue;
      const int first = std::max(0, middle - radius);
      const int last = std::min(field.columns() - 1, column);
      across[{middle, row}] = sum / (last - first + 1);
      if (middle >= radius) sum -= field[{row, middle - radius}];
    }
  }
  return across;  // transposed
}

/// Mean 0, mean deviation about half a metre, at most kMetre * 7 / 4.
Field Noise(int rows, int columns, int radius, Random& random) {
  Field field(rows, columns);
  constexpr std::int64_t kLargest = std::int64_t{1} << 40;
  for (std::int64_t& value : field.values()) value = random.Uniform(-kLargest, kLargest);
  for (int pass = 0; pass < 3; ++pass) field = Blurred(Blurred(field, radius), radius);
  std::int64_t deviation = 0;
  for (const std::int64_t value : field.values()) deviation += std::abs(value) / 4096;
  deviation = std::max<std::int64_t>(1, deviation / static_cast<std::int64_t>(field.size()));
  for (std::int64_t& value : field.values()) {
    value = std::clamp(value / 8 / deviation, -kMetre * 7 / 4, kMetre * 7 / 4);
  }
  return field;
}

// Stage 2: channels.

constexpr std::int64_t kSubcells = 16;

/// In 1/16 cells.
struct Point {
  std::int64_t x = 0;
  std::int64_t y = 0;
};

/// Chaikin's corner cutting; the ends stay.
std::vector<Point> Smooth(std::vector<Point> line) {
  for (int round = 0; round < 3; ++round) {
    std::vector<Point> next{line.front()};
    for (std::size_t i = 0; i + 1 < line.size(); ++i) {
      const Point a = line[i];
      const Point b = line[i + 1];
      next.push_back({(3 * a.x + b.x) / 4, (3 * a.y + b.y) / 4});
      next.push_back({(a.x + 3 * b.x) / 4, (a.y + 3 * b.y) / 4});
    }
    next.push_back(line.back());
    line = std::move(next);
  }
  return line;
}

std::int64_t SquaredDistance(Point point, Point a, Point b) {
  const Point along{b.x - a.x, b.y - a.y};
  const std::int64_t length = along.x * along.x + along.y * along.y;
  const std::int64_t dot = (point.x - a.x) * along.x + (point.y - a.y) * along.y;
  const std::int64_t share = std::clamp<std::int64_t>(dot, 0, length);
  const std::int64_t dx = point.x - a.x - (length == 0 ? 0 : along.x * share / length);
  const std::int64_t dy = point.y - a.y - (length == 0 ? 0 : along.y * share / length);
  return dx * dx + dy * dy;
}

/// The middle lines of the waterway, start in the west. Each coordinate is drawn from a range of
/// thousandths of the map's sides.
struct Channels {
  Channels(const TerrainOptions& options, Random& random)
      : options_(options), random_(random), mirrored_(random.Chance(0.5)) {
    const Point start = Draw(70, 90, 380, 620);
    const Point goal = Draw(910, 930, 400, 600);
    const Point fork = Draw(150, 190, 430, 570);
    // The way on leads around by the north.
    lines.push_back(Smooth({start, fork, Draw(200, 300, 110, 190), Draw(480, 600, 90, 160),
                            Draw(740, 830, 110, 230), Draw(900, 925, 240, 330), goal}));
    // The dead end leads straight towards the goal, with bends that hide its end.
    lines.push_back(Smooth({fork, Draw(290, 340, 430, 520), Draw(420, 480, 560, 680),
                            Draw(540, 600, 430, 520), Draw(660, 760, 500, 620)}));
    // A bay in the south.
    lines.push_back(Smooth({fork, Draw(200, 320, 760, 860), Draw(400, 560, 820, 900)}));
    this->start = CellOf(start);
    this->goal = CellOf(goal);
  }

  /// To the nearest middle line, in 1/16 cells.
  std::int64_t Distance(Cell cell) const {
    const Point middle{cell.column * kSubcells + kSubcells / 2,
                       cell.row * kSubcells + kSubcells / 2};
    std::int64_t nearest = std::int64_t{1} << 40;
    for (const std::vector<Point>& line : lines) {
      for (std::size_t i = 0; i + 1 < line.size(); ++i) {
        nearest = std::min(nearest, SquaredDistance(middle, line[i], line[i + 1]));
      }
    }
    return static_cast<std::int64_t>(std::sqrt(static_cast<double>(nearest)));
  }

  std::vector<std::vector<Point>> lines;
  Cell start;
  Cell goal;

 private:
  Point Draw(int west, int east, int north, int south) {
    const std::int64_t x = random_.Uniform(west, east);
    const std::int64_t y = random_.Uniform(north, south);
    return {x * options_.columns * kSubcells / 1000,
            (mirrored_ ? 1000 - y : y) * options_.rows * kSubcells / 1000};
  }
  static Cell CellOf(Point point) {
    return {static_cast<int>(point.y / kSubcells), static_cast<int>(point.x / kSubcells)};
  }

  const TerrainOptions& options_;
  Random& random_;
  bool mirrored_;
};

/// Deep in the middle of channels, land away from them, shores and lakes by the noise.
Field Heights(const TerrainOptions& options, const Channels& channels, Random& random) {
  const int side = std::min(options.rows, options.columns);
  const Field wide = Noise(options.rows, options.columns, std::max(2, side / 25), random);
  const Field fine = Noise(options.rows, options.columns, std::max(1, side / 75), random);
  const auto needed =
      static_cast<std::int64_t>(std::ceil((options.radius_cells + 1.0) * kSubcells));
  const std::int64_t core = std::max<std::int64_t>(side * kSubcells / 75, needed);
  const std::int64_t bank = side * kSubcells / 20;
  constexpr std::int64_t kDeep = -2 * kMetre;
  constexpr std::int64_t kLand = kMetre;
  Field heights(options.rows, options.columns);
  for (std::size_t i = 0; i < heights.size(); ++i) {
    const std::int64_t ashore =
        std::clamp<std::int64_t>(channels.Distance(heights.CellAt(i)) - core, 0, bank);
    const std::int64_t noise =
        std::clamp(wide.values()[i] * 3 / 2 + fine.values()[i] / 3, kDeep + 64, -kDeep - 64);
    heights.values()[i] = kDeep + (kLand - kDeep) * ashore / bank + noise;
  }
  return heights;
}

// Stage 3: what is promised.

/// The robot that takes the shortest way over what it has seen and not seen. It sees along the
/// lines from cell to cell.
class GreedyRobot {
 public:
  GreedyRobot(const OccupancyGrid& truth, const Grid<std::uint8_t>& room, Cell start, Cell goal)
      : truth_(truth), room_(room), known_(room.rows(), room.columns(), 1), goal_(goal) {
    walk_.push_back(start);
  }

  /// The cells it goes through; ends early after `most` steps.
  const std::vector<Cell>& Walk(int most) {
    while (walk_.back() != goal_ && static_cast<int>(walk_.size()) <= most) {
      Look(walk_.back());
      const std::vector<Cell> way = WayBack(StepsFrom(known_, goal_), walk_.back());
      if (way.empty()) return walk_;
      for (std::size_t i = 1; i < way.size() && room_[way[i]] != 0; ++i) {
        walk_.push_back(way[i]);
        constexpr std::size_t kCellsPerLook = 4;
        if (i % kCellsPerLook != 0) continue;
        Look(way[i]);
        const auto rest = way.begin() + static_cast<std::ptrdiff_t>(i);
        if (!std::all_of(rest, way.end(), [&](Cell cell) { return known_[cell] != 0; })) break;
      }
    }
    return walk_;
  }

 private:
  void Look(Cell from) {
    for (int side = -kGreedyRangeCells; side <= kGreedyRangeCells; ++side) {
      LookAlong(from, {side, -kGreedyRangeCells});
      LookAlong(from, {side, kGreedyRangeCells});
      LookAlong(from, {-kGreedyRangeCells, side});
      LookAlong(from, {kGreedyRangeCells, side});
    }
  }

  void LookAlong(Cell from, Cell offset) {
    constexpr int kRange = kGreedyRangeCells;
    // Rounds half away from zero, so that mirrored lines see mirrored cells.
    const auto part = [](int length, int i) {
      return (2 * length * i + (length < 0 ? -kRange : kRange)) / (2 * kRange);
    };
    for (int i = 0; i <= kRange; ++i) {
      const Cell away{part(offset.row, i), part(offset.column, i)};
      const Cell cell = from + away;
      if (away.row * away.row + away.column * away.column > kRange * kRange) return;
      if (!truth_.Contains(cell)) return;
      known_[cell] = room_[cell];
      if (truth_[cell] == Occupancy::kOccupied) return;
    }
  }

  const OccupancyGrid& truth_;
  const Grid<std::uint8_t>& room_;
  Grid<std::uint8_t> known_;  // 0 where it knows that it does not fit
  Cell goal_;
  std::vector<Cell> walk_;
};

std::int64_t SquaredDistance(Cell a, Cell b) {
  const Cell away = a - b;
  return std::int64_t{away.row} * away.row + std::int64_t{away.column} * away.column;
}

/// `a` is nearer to `goal` than `b` by `cells` at least.
bool IsNearerBy(int cells, Cell a, Cell b, Cell goal) {
  const double nearer = std::sqrt(static_cast<double>(SquaredDistance(a, goal)));
  return nearer + cells <= std::sqrt(static_cast<double>(SquaredDistance(b, goal)));
}

/// Fills in the ways and the dead end; false if a promise is broken.
bool Holds(const TerrainOptions& options, Terrain& terrain) {
  const Grid<std::uint8_t> room = RoomFor(terrain.truth, options.radius_cells);
  const Grid<int> steps = StepsFrom(room, terrain.goal);
  terrain.shortest_way = steps[terrain.start];
  if (terrain.shortest_way < 0) return false;
  GreedyRobot robot(terrain.truth, room, terrain.start, terrain.goal);
  const std::vector<Cell>& walk = robot.Walk(20 * terrain.shortest_way);
  terrain.greedy_way = static_cast<int>(walk.size()) - 1;
  terrain.dead_end = *std::ranges::max_element(walk, {}, [&](Cell cell) { return steps[cell]; });
  const int fifth = std::min(options.rows, options.columns) / 5;
  return walk.back() == terrain.goal &&
         terrain.greedy_way >= kGreedyDetour * terrain.shortest_way &&
         steps[terrain.dead_end] >= terrain.shortest_way + fifth &&
         IsNearerBy(fifth, terrain.dead_end, terrain.start, terrain.goal);
}

Terrain Draw(const TerrainOptions& options, std::uint64_t seed) {
  Random random(seed);
  const Channels channels(options, random);
  const Field heights = Heights(options, channels, random);
  Terrain terrain;
  terrain.start = channels.start;
  terrain.goal = channels.goal;
  terrain.heights = Grid<float>(options.rows, options.columns);
  terrain.truth = OccupancyGrid(options.rows, options.columns, Occupancy::kOccupied);
  for (std::size_t i = 0; i < heights.size(); ++i) {
    terrain.heights.values()[i] = static_cast<float>(heights.values()[i]) / float{kMetre};
    const bool border = terrain.truth.OnBorder(terrain.truth.CellAt(i));
    if (!border && heights.values()[i] < 0) terrain.truth.values()[i] = Occupancy::kFree;
  }
  return terrain;
}

Result<void> CheckTerrainOptions(const TerrainOptions& options) {
  for (const int side : {options.rows, options.columns}) {
    if (side >= kMinTerrainSide && side <= kMaxTerrainSide) continue;
    return Fail(ErrorCode::kOutOfRange,
                fmt::format("terrain of {} x {} cells: {} to {} per side", options.rows,
                            options.columns, kMinTerrainSide, kMaxTerrainSide));
  }
  const double widest = kMaxTerrainRadius * std::min(options.rows, options.columns);
  if (!(options.radius_cells >= 0.0 && options.radius_cells <= widest)) {
    return Fail(ErrorCode::kOutOfRange,
                fmt::format("a robot with a radius of {} cells is too wide for a waterway of {} x "
                            "{} cells: at most {}",
                            options.radius_cells, options.rows, options.columns, widest));
  }
  return {};
}

}  // namespace

Result<Terrain> MakeTerrain(const TerrainOptions& options, std::uint64_t seed) {
  if (const auto valid = CheckTerrainOptions(options); !valid) return tl::unexpected(valid.error());
  for (int draw = 1; draw <= kMostDraws; ++draw) {
    Terrain terrain = Draw(options, DeriveSeed(seed, static_cast<std::uint64_t>(draw)));
    terrain.draws = draw;
    if (Holds(options, terrain)) return terrain;
  }
  return Fail(ErrorCode::kUnavailable,
              fmt::format("seed {}: none of {} waterways of {} x {} cells has a dead end that "
                          "tempts the greedy robot",
                          seed, kMostDraws, options.rows, options.columns));
}

}  // namespace conav::sim
