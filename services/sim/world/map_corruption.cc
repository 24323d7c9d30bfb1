#include "sim/world/map_corruption.h"

#include <fmt/format.h>

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

}  // namespace conav::sim
