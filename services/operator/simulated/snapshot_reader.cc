#include "operator/simulated/snapshot_reader.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "operator/simulated/path_planner.h"

namespace conav::operators {
namespace {

constexpr double kRadiansPerDegree = std::numbers::pi / 180.0;

double Distance(Cell a, Cell b) { return std::hypot(a.row - b.row, a.column - b.column); }

bool ContinuesWall(const BeliefGrid& belief, Cell cell) {
  return std::any_of(kNeighbourOffsets.begin(), kNeighbourOffsets.end(), [&](Cell offset) {
    return belief.Contains(cell + offset) && IsWall(belief, cell + offset);
  });
}

}  // namespace

Cell AxisOffset(double heading_rad) {
  return {-static_cast<int>(std::lround(std::sin(heading_rad))),
          static_cast<int>(std::lround(std::cos(heading_rad)))};
}

/// One picture and the map.
struct SnapshotReading::Look {
  const BeliefGrid& belief;
  const Snapshot& snapshot;
  const std::set<Cell>& certain;
  std::set<Cell> driven;  // the robot's cell and path: free beyond doubt

  bool Editable(Cell cell) const {
    return belief.Contains(cell) && !belief.OnBorder(cell) && !certain.contains(cell);
  }
  bool MayBecomeWall(Cell cell) const {
    return Editable(cell) && !driven.contains(cell) && !IsWall(belief, cell);
  }
  double AngleOffAxis(Cell cell) const {
    return std::abs(WrapAngle(HeadingTowards(snapshot.cell, cell) - snapshot.heading_rad));
  }
  /// Discrepancies, nearest first.
  std::vector<CellEdit> Discrepancies() const {
    std::set<Cell> remove = driven;
    remove.insert(snapshot.visible.free.begin(), snapshot.visible.free.end());
    std::vector<CellEdit> edits;
    for (const Cell cell : remove) {
      if (Editable(cell) && IsWall(belief, cell)) edits.push_back({cell, false});
    }
    for (const Cell cell : snapshot.visible.walls) {
      if (MayBecomeWall(cell)) edits.push_back({cell, true});
    }
    std::stable_sort(edits.begin(), edits.end(), [this](const CellEdit& a, const CellEdit& b) {
      const double da = Distance(snapshot.cell, a.cell);
      const double db = Distance(snapshot.cell, b.cell);
      return da != db ? da < db : a.cell < b.cell;
    });
    return edits;
  }
  /// Cells next to those that the picture shows, flipped.
  std::vector<CellEdit> Guesses() const {
    std::set<Cell> shown(snapshot.visible.free.begin(), snapshot.visible.free.end());
    shown.insert(snapshot.visible.walls.begin(), snapshot.visible.walls.end());
    std::set<Cell> near_cells;
    for (const Cell cell : shown) {
      for (const Cell offset : kNeighbourOffsets) {
        const Cell next = cell + offset;
        if (Editable(next) && !shown.contains(next) && !driven.contains(next))
          near_cells.insert(next);
      }
    }
    std::vector<CellEdit> guesses;
    for (const Cell cell : near_cells) guesses.push_back({cell, !IsWall(belief, cell)});
    return guesses;
  }
};

SnapshotReading::SnapshotReading(const SnapshotReaderParameters& parameters,
                                 const BeliefGrid& belief, const Snapshot& snapshot,
                                 const std::set<Cell>& certain)
    : parameters_(parameters) {
  Look look{belief, snapshot, certain, {snapshot.path.begin(), snapshot.path.end()}};
  look.driven.insert(snapshot.cell);
  for (const CellEdit& edit : look.Discrepancies()) discrepancies_.push_back(Weigh(look, edit));
  if (parameters.guess_probability > 0.0) guesses_ = look.Guesses();
}

double SnapshotReading::EditProbability(const Look& look, Cell cell) const {
  return parameters_.edit_probability *
         std::exp(-Distance(look.snapshot.cell, cell) / parameters_.decay_cells);
}

double SnapshotReading::AddProbability(const Look& look, Cell cell) const {
  const double distance = Distance(look.snapshot.cell, cell);
  const double off_axis = look.AngleOffAxis(cell);
  const double probability = EditProbability(look, cell);
  if (distance >= parameters_.far_cells) {
    const bool central = off_axis <= parameters_.centre_deg * kRadiansPerDegree;
    return central && ContinuesWall(look.belief, cell)
               ? std::max(probability, parameters_.far_centre_probability)
               : probability;
  }
  const bool lateral = off_axis > parameters_.lateral_deg * kRadiansPerDegree;
  return lateral ? probability * parameters_.lateral_factor : probability;
}

double SnapshotReading::RemoveProbability(const Look& look, Cell cell) const {
  return look.driven.contains(cell) ? parameters_.path_removal_probability
                                    : EditProbability(look, cell);
}

SnapshotReading::Discrepancy SnapshotReading::Weigh(const Look& look, const CellEdit& edit) const {
  const Cell cell = edit.cell;
  if (!edit.wall) return {edit, RemoveProbability(look, cell), false, cell, cell};
  const Cell axis = AxisOffset(look.snapshot.heading_rad);
  const auto allowed = [&](Cell place) { return look.MayBecomeWall(place) ? place : cell; };
  return {edit, AddProbability(look, cell),
          Distance(look.snapshot.cell, cell) <= parameters_.near_cells, allowed(cell + axis),
          allowed(cell - axis)};
}

Cell SnapshotReading::DrawPlace(const Discrepancy& discrepancy, Random& random) const {
  if (!discrepancy.near || !random.Chance(parameters_.misplacement_probability)) {
    return discrepancy.edit.cell;
  }
  return random.Chance(0.5) ? discrepancy.beyond : discrepancy.before;
}

std::vector<CellEdit> SnapshotReading::Draw(Random& random) const {
  if (random.Chance(parameters_.lapse_probability)) return {};
  std::vector<CellEdit> edits;
  for (const Discrepancy& discrepancy : discrepancies_) {
    if (edits.size() >= static_cast<std::size_t>(parameters_.edit_limit)) break;
    if (!random.Chance(discrepancy.probability)) continue;
    edits.push_back({DrawPlace(discrepancy, random), discrepancy.edit.wall});
  }
  if (random.Chance(parameters_.guess_probability) && !guesses_.empty()) {
    const auto last = static_cast<std::int64_t>(guesses_.size()) - 1;
    edits.push_back(guesses_[static_cast<std::size_t>(random.Uniform(0, last))]);
  }
  std::stable_sort(edits.begin(), edits.end(),
                   [](const CellEdit& a, const CellEdit& b) { return a.cell < b.cell; });
  const auto same_cell = [](const CellEdit& a, const CellEdit& b) { return a.cell == b.cell; };
  edits.erase(std::unique(edits.begin(), edits.end(), same_cell), edits.end());
  return edits;
}

std::vector<Cell> SnapshotReading::PossibleCells() const {
  std::set<Cell> cells;
  for (const Discrepancy& discrepancy : discrepancies_) {
    cells.insert(discrepancy.edit.cell);
    if (discrepancy.near && parameters_.misplacement_probability > 0.0) {
      cells.insert({discrepancy.beyond, discrepancy.before});
    }
  }
  for (const CellEdit& guess : guesses_) cells.insert(guess.cell);
  return {cells.begin(), cells.end()};
}

SnapshotReader::SnapshotReader(const SnapshotReaderParameters& parameters, std::uint64_t seed)
    : parameters_(parameters), random_(seed) {}

std::vector<CellEdit> SnapshotReader::Read(const BeliefGrid& belief, const Snapshot& snapshot,
                                           const std::set<Cell>& certain) {
  return SnapshotReading(parameters_, belief, snapshot, certain).Draw(random_);
}

}  // namespace conav::operators
