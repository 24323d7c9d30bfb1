#include "operator/simulated/picture_reader.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "operator/simulated/path_planner.h"

namespace conav::operators {
namespace {

constexpr double kRadiansPerDegree = std::numbers::pi / 180.0;

double Distance(Cell a, Cell b) { return std::hypot(a.row - b.row, a.column - b.column); }

/// The neighbouring cell that `heading_rad` points to, as an offset; diagonals included.
Cell AxisOffset(double heading_rad) {
  return {-static_cast<int>(std::lround(std::sin(heading_rad))),
          static_cast<int>(std::lround(std::cos(heading_rad)))};
}

bool ContinuesWall(const BeliefGrid& belief, Cell cell) {
  return std::any_of(kNeighbourOffsets.begin(), kNeighbourOffsets.end(), [&](Cell offset) {
    return belief.Contains(cell + offset) && IsWall(belief, cell + offset);
  });
}

}  // namespace

/// One picture beside the map.
struct PictureReader::Look {
  const BeliefGrid& belief;
  const Picture& picture;
  const std::set<Cell>& certain;
  std::set<Cell> driven;  // the robot's cell and path: free beyond doubt

  bool Editable(Cell cell) const {
    return belief.Contains(cell) && !belief.OnBorder(cell) && !certain.contains(cell);
  }
  bool MayBecomeWall(Cell cell) const {
    return Editable(cell) && !driven.contains(cell) && !IsWall(belief, cell);
  }
  double AngleOffAxis(Cell cell) const {
    return std::abs(WrapAngle(HeadingTowards(picture.cell, cell) - picture.heading_rad));
  }
  /// Discrepancies, nearest first.
  std::vector<CellEdit> Discrepancies() const {
    std::set<Cell> remove;
    for (const Cell cell : driven) remove.insert(cell);
    for (const Cell cell : picture.visible.free) remove.insert(cell);
    std::vector<CellEdit> edits;
    for (const Cell cell : remove) {
      if (Editable(cell) && IsWall(belief, cell)) edits.push_back({cell, false});
    }
    for (const Cell cell : picture.visible.walls) {
      if (MayBecomeWall(cell)) edits.push_back({cell, true});
    }
    std::stable_sort(edits.begin(), edits.end(), [this](const CellEdit& a, const CellEdit& b) {
      const double da = Distance(picture.cell, a.cell);
      const double db = Distance(picture.cell, b.cell);
      return da != db ? da < db : a.cell < b.cell;
    });
    return edits;
  }
};

PictureReader::PictureReader(const PictureReaderParameters& parameters, std::uint64_t seed)
    : parameters_(parameters), random_(seed) {}

double PictureReader::EditProbability(const Look& look, Cell cell) const {
  return parameters_.edit_probability *
         std::exp(-Distance(look.picture.cell, cell) / parameters_.decay_cells);
}

double PictureReader::AddProbability(const Look& look, Cell cell) const {
  const double distance = Distance(look.picture.cell, cell);
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

Cell PictureReader::PlaceWall(const Look& look, Cell cell) {
  if (Distance(look.picture.cell, cell) > parameters_.near_cells) return cell;
  if (!random_.Chance(parameters_.misplacement_probability)) return cell;
  const Cell axis = AxisOffset(look.picture.heading_rad);
  const Cell misplaced = random_.Chance(0.5) ? cell + axis : cell - axis;
  return look.MayBecomeWall(misplaced) ? misplaced : cell;
}

void PictureReader::Guess(const Look& look, std::vector<CellEdit>& edits) {
  if (!random_.Chance(parameters_.guess_probability)) return;
  std::set<Cell> shown(look.picture.visible.free.begin(), look.picture.visible.free.end());
  shown.insert(look.picture.visible.walls.begin(), look.picture.visible.walls.end());
  std::set<Cell> beside;
  for (const Cell cell : shown) {
    for (const Cell offset : kNeighbourOffsets) {
      const Cell next = cell + offset;
      if (look.Editable(next) && !shown.contains(next) && !look.driven.contains(next)) {
        beside.insert(next);
      }
    }
  }
  if (beside.empty()) return;
  const auto index = random_.Uniform(0, static_cast<std::int64_t>(beside.size()) - 1);
  const Cell cell = *std::next(beside.begin(), index);
  edits.push_back({cell, !IsWall(look.belief, cell)});
}

std::vector<CellEdit> PictureReader::Read(const BeliefGrid& belief, const Picture& picture,
                                          const std::set<Cell>& certain) {
  Look look{belief, picture, certain, {picture.path.begin(), picture.path.end()}};
  look.driven.insert(picture.cell);
  if (random_.Chance(parameters_.lapse_probability)) return {};

  std::vector<CellEdit> edits;
  for (const CellEdit& error : look.Discrepancies()) {
    if (edits.size() >= static_cast<std::size_t>(parameters_.edit_limit)) break;
    if (error.wall) {
      if (!random_.Chance(AddProbability(look, error.cell))) continue;
      edits.push_back({PlaceWall(look, error.cell), true});
    } else {
      const double probability = look.driven.contains(error.cell)
                                     ? parameters_.path_removal_probability
                                     : EditProbability(look, error.cell);
      if (random_.Chance(probability)) edits.push_back(error);
    }
  }
  Guess(look, edits);
  std::stable_sort(edits.begin(), edits.end(),
                   [](const CellEdit& a, const CellEdit& b) { return a.cell < b.cell; });
  const auto same_cell = [](const CellEdit& a, const CellEdit& b) { return a.cell == b.cell; };
  edits.erase(std::unique(edits.begin(), edits.end(), same_cell), edits.end());
  return edits;
}

}  // namespace conav::operators
