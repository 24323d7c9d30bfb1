#include "sim/world/map_corruption.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "common/runtime/random.h"

namespace conav::sim {
namespace {

struct Candidate {
  Cell cell;
  double weight = 0.0;
};

struct Candidates {
  std::vector<Candidate> free;   // may become false walls
  std::vector<Candidate> walls;  // may go missing
};

/// Smooth random field: a few Gaussian bumps over a constant background.
class ErrorField {
 public:
  ErrorField(const OccupancyGrid& truth, const MapCorruptionOptions& options, Random& random)
      : options_(options) {
    for (int i = 0; i < options.clusters; ++i) {
      const double row = random.Unit() * truth.rows();
      const double column = random.Unit() * truth.columns();
      centres_.push_back({row, column});
    }
  }

  double At(Cell cell) const {
    const double spread = 2.0 * options_.cluster_radius_cells * options_.cluster_radius_cells;
    double value = options_.background;
    for (const auto& [row, column] : centres_) {
      const double distance = std::hypot(cell.row + 0.5 - row, cell.column + 0.5 - column);
      value += std::exp(-distance * distance / spread);
    }
    return value;
  }

 private:
  MapCorruptionOptions options_;
  std::vector<std::pair<double, double>> centres_;  // row, column
};

bool HasFreeNeighbour(const OccupancyGrid& truth, Cell cell) {
  return std::any_of(kNeighbourOffsets.begin(), kNeighbourOffsets.end(), [&](Cell offset) {
    const Cell neighbour = cell + offset;
    return truth.Contains(neighbour) && truth[neighbour] == Occupancy::kFree;
  });
}

Candidates FindCandidates(const OccupancyGrid& truth, const std::set<Cell>& kept,
                          const ErrorField& field) {
  Candidates candidates;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    const Cell cell = truth.CellAt(i);
    if (truth.OnBorder(cell) || kept.contains(cell)) continue;
    if (truth[cell] == Occupancy::kFree) {
      candidates.free.push_back({cell, field.At(cell)});
    } else if (HasFreeNeighbour(truth, cell)) {
      candidates.walls.push_back({cell, field.At(cell)});
    }
  }
  return candidates;
}

/// Removes one candidate, with a probability proportional to its weight.
Cell TakeWeighted(std::vector<Candidate>& candidates, Random& random) {
  double total = 0.0;
  for (const Candidate& candidate : candidates) total += candidate.weight;
  double rest = random.Unit() * total;
  std::size_t chosen = 0;
  while (chosen + 1 < candidates.size() && rest >= candidates[chosen].weight) {
    rest -= candidates[chosen].weight;
    ++chosen;
  }
  const Cell cell = candidates[chosen].cell;
  candidates.erase(candidates.begin() + static_cast<std::ptrdiff_t>(chosen));
  return cell;
}

}  // namespace

Result<OccupancyGrid> CorruptMap(const OccupancyGrid& truth, const std::set<Cell>& kept,
                                 const MapCorruptionOptions& options, std::uint64_t seed) {
  DEMAND(options.wrong_share >= 0.0 && options.wrong_share <= 1.0, options.wrong_share);
  DEMAND(options.false_wall_share >= 0.0 && options.false_wall_share <= 1.0,
         options.false_wall_share);
  Random random(seed);
  const ErrorField field(truth, options, random);
  Candidates candidates = FindCandidates(truth, kept, field);
  const auto count = static_cast<std::size_t>(
      std::llround(options.wrong_share * static_cast<double>(truth.size())));
  const std::size_t possible = candidates.free.size() + candidates.walls.size();
  if (count > possible) {
    return Fail(
        ErrorCode::kOutOfRange,
        fmt::format("the operator's map cannot have {} wrong cells: only {} cells may be wrong",
                    count, possible));
  }
  const auto wanted =
      static_cast<std::size_t>(std::floor(options.false_wall_share * static_cast<double>(count)));
  const std::size_t missing = count - std::min(candidates.free.size(), wanted);
  const std::size_t walls = std::min(missing, candidates.walls.size());
  OccupancyGrid map = truth;
  for (std::size_t i = 0; i < walls; ++i) {
    map[TakeWeighted(candidates.walls, random)] = Occupancy::kFree;
  }
  for (std::size_t i = walls; i < count; ++i) {
    map[TakeWeighted(candidates.free, random)] = Occupancy::kOccupied;
  }
  return map;
}

namespace {

/// Changes a map in connected pieces.
class Silting {
 public:
  Silting(const OccupancyGrid& truth, const Grid<std::uint8_t>& kept, std::uint64_t seed)
      : truth_(truth),
        kept_(kept),
        random_(seed),
        map_(truth),
        taken_(truth.rows(), truth.columns(), 0) {
    const auto water = std::ranges::count(truth.values(), Occupancy::kFree);
    piece_ = std::max(kSmallestPiece, static_cast<int>(water / 40));
  }

  /// Silts up (`to` is kOccupied) or opens `count` cells; how many it could not change.
  int Change(Occupancy to, int count) {
    std::vector<Cell> seeds;
    for (std::size_t i = 0; i < truth_.size(); ++i) {
      const Cell cell = truth_.CellAt(i);
      if (MayBecome(cell, to) && (to == Occupancy::kOccupied || HasFreeNeighbour(truth_, cell))) {
        seeds.push_back(cell);
      }
    }
    int smallest = kSmallestPiece;
    for (int failed = 0; count > 0 && !seeds.empty();) {
      const Cell seed = seeds[Below(seeds.size())];
      const std::vector<Cell> piece =
          to == Occupancy::kOccupied ? Plug(seed, count) : Cut(seed, count);
      const bool fits = static_cast<int>(piece.size()) >= std::min(smallest, count);
      for (const Cell cell : piece) {
        taken_[cell] = 0;
        if (fits) map_[cell] = to;
      }
      if (fits) {
        count -= static_cast<int>(piece.size());
      } else if (++failed == kMostFailures) {
        if (smallest == 1) break;
        smallest = 1;
        failed = 0;
      }
    }
    return count;
  }

  OccupancyGrid Map() { return std::move(map_); }

 private:
  static constexpr int kMostFailures = 1000;

  std::size_t Below(std::size_t count) {
    return static_cast<std::size_t>(random_.Uniform(0, static_cast<std::int64_t>(count) - 1));
  }

  bool MayBecome(Cell cell, Occupancy to) const {
    return truth_.Contains(cell) && !truth_.OnBorder(cell) && kept_[cell] == 0 &&
           truth_[cell] != to && map_[cell] != to && taken_[cell] == 0;
  }

  void Take(Cell cell, std::vector<Cell>& piece) {
    taken_[cell] = 1;
    piece.push_back(cell);
  }

  bool Touches(Cell cell) const {
    return std::ranges::any_of(kNeighbourOffsets, [&](Cell offset) {
      return taken_.Contains(cell + offset) && taken_[cell + offset] != 0;
    });
  }

  /// Grows from `seed` within a disc, neighbour by neighbour.
  std::vector<Cell> Plug(Cell seed, int most) {
    std::vector<Cell> piece;
    if (!MayBecome(seed, Occupancy::kOccupied)) return piece;
    Take(seed, piece);
    const auto limit = static_cast<std::size_t>(std::min(most, piece_));
    for (std::size_t next = 0; next < piece.size(); ++next) {
      for (const Cell offset : kNeighbourOffsets) {
        const Cell cell = piece[next] + offset;
        const Cell away = cell - seed;
        if (piece.size() >= limit) return piece;
        if (2 * (away.row * away.row + away.column * away.column) > piece_) continue;
        if (MayBecome(cell, Occupancy::kOccupied)) Take(cell, piece);
      }
    }
    return piece;
  }

  /// A channel from the shore cell `seed` straight through the land, up to the next water or as long
  /// as a piece.
  std::vector<Cell> Cut(Cell seed, int most) {
    constexpr int kHalfWidth = 2;
    std::vector<Cell> piece;
    const int side = std::max(truth_.rows(), truth_.columns());
    const Cell towards{static_cast<int>(random_.Uniform(-side, side)),
                       static_cast<int>(random_.Uniform(-side, side))};
    const int length = std::max({std::abs(towards.row), std::abs(towards.column), 1});
    const auto limit = static_cast<std::size_t>(std::min(most, piece_));
    for (int i = 0; i <= length && piece.size() < limit; ++i) {
      const Cell middle = seed + Cell{towards.row * i / length, towards.column * i / length};
      const bool goes_on = piece.empty() || taken_[middle] != 0 || Touches(middle);
      if (!goes_on || (taken_[middle] == 0 && !MayBecome(middle, Occupancy::kFree))) break;
      if (taken_[middle] == 0) Take(middle, piece);
      for (int row = -kHalfWidth; row <= kHalfWidth; ++row) {
        for (int column = -kHalfWidth; column <= kHalfWidth; ++column) {
          const Cell cell = middle + Cell{row, column};
          if (std::abs(row) + std::abs(column) > kHalfWidth + 1 || piece.size() >= limit) continue;
          if (MayBecome(cell, Occupancy::kFree) && Touches(cell)) Take(cell, piece);
        }
      }
    }
    return piece;
  }

  const OccupancyGrid& truth_;
  const Grid<std::uint8_t>& kept_;
  Random random_;
  OccupancyGrid map_;
  Grid<std::uint8_t> taken_;  // of the piece that grows
  int piece_;
};

}  // namespace

Result<OccupancyGrid> SiltMap(const OccupancyGrid& truth, const Grid<std::uint8_t>& kept,
                              const MapCorruptionOptions& options, std::uint64_t seed) {
  const auto water = static_cast<double>(std::ranges::count(truth.values(), Occupancy::kFree));
  const int count = static_cast<int>(std::llround(options.wrong_share * water));
  const int silted = static_cast<int>(std::floor(options.false_wall_share * count));
  Silting silting(truth, kept, seed);
  int left = silting.Change(Occupancy::kFree, count - silted);
  left = silting.Change(Occupancy::kOccupied, silted + left);
  if (left > 0) left = silting.Change(Occupancy::kFree, left);
  if (left > 0) {
    return Fail(
        ErrorCode::kOutOfRange,
        fmt::format("the operator's map cannot have {} wrong cells: {} of them find no place",
                    count, left));
  }
  return silting.Map();
}

}  // namespace conav::sim
