#include "operator/simulated/snapshot_reader.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <span>
#include <utility>

#include "common/runtime/config.h"
#include "operator/simulated/path_planner.h"

namespace conav::operators {
namespace {

constexpr double kRadiansPerDegree = std::numbers::pi / 180.0;

/// What the parameters call a cell.
constexpr double kParameterCellM = 2.0;

double Distance(Cell a, Cell b) { return std::hypot(a.row - b.row, a.column - b.column); }

bool ContinuesWall(const BeliefGrid& belief, Cell cell) {
  return std::any_of(kNeighbourOffsets.begin(), kNeighbourOffsets.end(), [&](Cell offset) {
    return belief.Contains(cell + offset) && IsWall(belief, cell + offset);
  });
}

/// The cell of `cells` that is nearest to their centroid, of several the first.
Cell CentreOf(const std::vector<Cell>& cells) {
  double row = 0.0;
  double column = 0.0;
  for (const Cell cell : cells) {
    row += cell.row;
    column += cell.column;
  }
  const auto count = static_cast<double>(cells.size());
  return *std::ranges::min_element(cells, {}, [&](Cell cell) {
    return std::hypot(cell.row - row / count, cell.column - column / count);
  });
}

}  // namespace

Cell AxisOffset(double heading_rad) {
  return {-static_cast<int>(std::lround(std::sin(heading_rad))),
          static_cast<int>(std::lround(std::cos(heading_rad)))};
}

/// One picture and the map.
struct SnapshotReading::Look {
  /// What is known of a cell from the picture.
  enum class Mark : std::uint8_t { kNone, kDriven, kFree, kWall };

  Look(const BeliefGrid& belief, const Snapshot& snapshot, const std::set<Cell>& certain)
      : belief(belief),
        snapshot(snapshot),
        certain(certain),
        unit(IsRaster(snapshot.grid.cell_size_m) ? snapshot.grid.cell_size_m / kParameterCellM
                                                 : 1.0),
        side(EditSide(snapshot.grid.cell_size_m)),
        marks(belief.rows(), belief.columns(), Mark::kNone) {
    MarkAll(snapshot.visible.walls, Mark::kWall);
    MarkAll(snapshot.visible.free, Mark::kFree);
    MarkAll(snapshot.path, Mark::kDriven);  // the robot's cell and path: free beyond doubt
    MarkAll({&snapshot.cell, 1}, Mark::kDriven);
  }

  void MarkAll(std::span<const Cell> cells, Mark mark) {
    for (const Cell cell : cells) {
      if (!marks.Contains(cell)) continue;
      marks[cell] = mark;
      if (Editable(cell)) marked.push_back(cell);
    }
  }
  bool Editable(Cell cell) const {
    return belief.Contains(cell) && !belief.OnBorder(cell) && !certain.contains(cell);
  }
  bool MayBecomeWall(Cell cell) const {
    return Editable(cell) && marks[cell] != Mark::kDriven && !IsWall(belief, cell);
  }
  bool MayBeGuessed(Cell cell) const { return Editable(cell) && marks[cell] == Mark::kNone; }
  double AngleOffAxis(Cell cell) const {
    return std::abs(WrapAngle(HeadingTowards(snapshot.cell, cell) - snapshot.heading_rad));
  }
  Cell SquareOf(Cell cell) const { return {cell.row / side, cell.column / side}; }
  bool Differs(Cell cell) const { return IsWall(belief, cell) != (marks[cell] == Mark::kWall); }
  std::vector<Patch> Differences() const;
  std::vector<Patch> Guesses() const;
  Patch GuessAround(Cell cell) const;

  const BeliefGrid& belief;
  const Snapshot& snapshot;
  const std::set<Cell>& certain;
  double unit;  // of a distance in the parameters' cells, per cell of the map
  int side;     // of a patch's square, in cells of the map
  Grid<Mark> marks;
  std::vector<Cell> marked;  // those that may be edited; some twice
};

/// In no order of use.
std::vector<SnapshotReading::Patch> SnapshotReading::Look::Differences() const {
  Grid<std::uint8_t> left(belief.rows(), belief.columns(), 0);
  for (const Cell cell : marked) left[cell] = Differs(cell);
  std::vector<Patch> patches;
  for (const Cell first : marked) {
    if (std::exchange(left[first], std::uint8_t{0}) == 0) continue;
    Patch patch{marks[first] == Mark::kWall, {first}};
    for (std::size_t i = 0; i < patch.cells.size(); ++i) {
      for (const Cell offset : kNeighbourOffsets) {
        const Cell next = patch.cells[i] + offset;
        if (!left.Contains(next) || left[next] == 0 || marks[next] != marks[first] ||
            SquareOf(next) != SquareOf(first)) {
          continue;
        }
        left[next] = 0;
        patch.cells.push_back(next);
      }
    }
    patches.push_back(std::move(patch));
  }
  return patches;
}

/// The cells of its square that the picture does not show and that are like `cell`, flipped.
SnapshotReading::Patch SnapshotReading::Look::GuessAround(Cell cell) const {
  const Cell square = SquareOf(cell);
  Patch patch{!IsWall(belief, cell), {}};
  for (int row = square.row * side; row < (square.row + 1) * side; ++row) {
    for (int column = square.column * side; column < (square.column + 1) * side; ++column) {
      const Cell next{row, column};
      if (MayBeGuessed(next) && IsWall(belief, next) != patch.wall) patch.cells.push_back(next);
    }
  }
  return patch;
}

/// One for each square next to what the picture shows.
std::vector<SnapshotReading::Patch> SnapshotReading::Look::Guesses() const {
  std::map<Cell, Cell> first_of_square;
  const auto add_neighbours = [&](Cell cell) {
    for (const Cell offset : kNeighbourOffsets) {
      const Cell next = cell + offset;
      if (!MayBeGuessed(next)) continue;
      const auto [entry, is_new] = first_of_square.emplace(SquareOf(next), next);
      if (!is_new) entry->second = std::min(entry->second, next);
    }
  };
  std::ranges::for_each(snapshot.visible.free, add_neighbours);
  std::ranges::for_each(snapshot.visible.walls, add_neighbours);
  std::vector<Patch> guesses;
  for (const auto& [square, cell] : first_of_square) guesses.push_back(GuessAround(cell));
  return guesses;
}

SnapshotReading::SnapshotReading(const SnapshotReaderParameters& parameters,
                                 const BeliefGrid& belief, const Snapshot& snapshot,
                                 const std::set<Cell>& certain, const PictureMemory& memory)
    : parameters_(parameters) {
  if (parameters.mechanism != ReadingMechanism::kPaper) {
    sight_.emplace(belief, snapshot, certain, memory);
    return;
  }
  const Look look(belief, snapshot, certain);
  for (Patch& patch : look.Differences()) discrepancies_.push_back(Weigh(look, std::move(patch)));
  std::ranges::sort(discrepancies_, [](const Discrepancy& a, const Discrepancy& b) {
    return a.distance != b.distance ? a.distance < b.distance : a.centre < b.centre;
  });
  if (parameters.guess_probability > 0.0) guesses_ = look.Guesses();
}

double SnapshotReading::EditProbability(double distance) const {
  return parameters_.edit_probability * std::exp(-distance / parameters_.decay_cells);
}

double SnapshotReading::AddProbability(const Look& look, const Discrepancy& discrepancy) const {
  const double off_axis = look.AngleOffAxis(discrepancy.centre);
  const double probability = EditProbability(discrepancy.distance);
  if (discrepancy.distance >= parameters_.far_cells) {
    const bool central = off_axis <= parameters_.centre_deg * kRadiansPerDegree;
    const auto continues = [&](Cell cell) { return ContinuesWall(look.belief, cell); };
    return central && std::ranges::any_of(discrepancy.patch.cells, continues)
               ? std::max(probability, parameters_.far_centre_probability)
               : probability;
  }
  const bool lateral = off_axis > parameters_.lateral_deg * kRadiansPerDegree;
  return lateral ? probability * parameters_.lateral_factor : probability;
}

SnapshotReading::Discrepancy SnapshotReading::Weigh(const Look& look, Patch patch) const {
  const Cell centre = CentreOf(patch.cells);
  Discrepancy discrepancy{.patch = std::move(patch),
                          .centre = centre,
                          .distance = Distance(look.snapshot.cell, centre) * look.unit};
  if (!discrepancy.patch.wall) {
    discrepancy.probability = look.marks[centre] == Look::Mark::kDriven
                                  ? parameters_.path_removal_probability
                                  : EditProbability(discrepancy.distance);
    return discrepancy;
  }
  discrepancy.probability = AddProbability(look, discrepancy);
  if (discrepancy.distance > parameters_.near_cells) return discrepancy;
  const Cell axis = AxisOffset(look.snapshot.heading_rad);
  const int off = static_cast<int>(std::lround(1.0 / look.unit));
  const auto shifted = [&](int by) {
    std::vector<Cell> places;
    for (const Cell cell : discrepancy.patch.cells) {
      const Cell place{cell.row + by * axis.row, cell.column + by * axis.column};
      places.push_back(look.MayBecomeWall(place) ? place : cell);
    }
    return places;
  };
  discrepancy.beyond = shifted(off);
  discrepancy.before = shifted(-off);
  return discrepancy;
}

const std::vector<Cell>& SnapshotReading::DrawPlaces(const Discrepancy& discrepancy,
                                                     Random& random) const {
  if (discrepancy.beyond.empty() || !random.Chance(parameters_.misplacement_probability)) {
    return discrepancy.patch.cells;
  }
  return random.Chance(0.5) ? discrepancy.beyond : discrepancy.before;
}

std::vector<CellEdit> SnapshotReading::Draw(Random& random) const {
  if (random.Chance(parameters_.lapse_probability)) return {};
  std::vector<CellEdit> edits;
  const auto add = [&](const std::vector<Cell>& cells, bool wall) {
    if (edits.size() + cells.size() > kMostEditedCells) return;
    for (const Cell cell : cells) edits.push_back({cell, wall});
  };
  int patches = 0;
  if (sight_) edits = sight_->Draw(parameters_, random);
  for (const Discrepancy& discrepancy : discrepancies_) {
    if (patches >= parameters_.edit_limit) break;
    if (!random.Chance(discrepancy.probability)) continue;
    ++patches;
    add(DrawPlaces(discrepancy, random), discrepancy.patch.wall);
  }
  if (!sight_ && random.Chance(parameters_.guess_probability) && !guesses_.empty()) {
    const auto last = static_cast<std::int64_t>(guesses_.size()) - 1;
    const Patch& guess = guesses_[static_cast<std::size_t>(random.Uniform(0, last))];
    add(guess.cells, guess.wall);
  }
  std::stable_sort(edits.begin(), edits.end(),
                   [](const CellEdit& a, const CellEdit& b) { return a.cell < b.cell; });
  const auto same_cell = [](const CellEdit& a, const CellEdit& b) { return a.cell == b.cell; };
  edits.erase(std::unique(edits.begin(), edits.end(), same_cell), edits.end());
  return edits;
}

std::vector<Cell> SnapshotReading::PossibleCells() const {
  std::set<Cell> cells;
  const auto add = [&](const std::vector<Cell>& more) { cells.insert(more.begin(), more.end()); };
  for (const Discrepancy& discrepancy : discrepancies_) {
    add(discrepancy.patch.cells);
    if (parameters_.misplacement_probability == 0.0) continue;
    add(discrepancy.beyond);
    add(discrepancy.before);
  }
  for (const Patch& guess : guesses_) add(guess.cells);
  for (std::size_t i = 0; sight_ && i < sight_->editable.size(); ++i) {
    if (sight_->editable.values()[i] != 0) cells.insert(sight_->editable.CellAt(i));
  }
  return {cells.begin(), cells.end()};
}

SnapshotReader::SnapshotReader(const SnapshotReaderParameters& parameters, std::uint64_t seed)
    : parameters_(parameters), random_(seed) {}

std::vector<CellEdit> SnapshotReader::Read(const BeliefGrid& belief, const Snapshot& snapshot,
                                           const std::set<Cell>& certain) {
  auto edits = SnapshotReading(parameters_, belief, snapshot, certain, memory_).Draw(random_);
  if (parameters_.mechanism == ReadingMechanism::kMemory) Remember(snapshot, memory_);
  return edits;
}

void SnapshotReaderParameters::Visit(ConfigReader& reader) {
  reader.Field("edit_probability", edit_probability, 0.0, 1.0);
  reader.Field("decay_cells", decay_cells, 0.01, 1e6);
  reader.Field("path_removal_probability", path_removal_probability, 0.0, 1.0);
  reader.Field("far_centre_probability", far_centre_probability, 0.0, 1.0);
  reader.Field("far_cells", far_cells, 0.0, 1e6);
  reader.Field("centre_deg", centre_deg, 0.0, 180.0);
  reader.Field("lateral_factor", lateral_factor, 0.0, 1.0);
  reader.Field("lateral_deg", lateral_deg, 0.0, 180.0);
  reader.Field("misplacement_probability", misplacement_probability, 0.0, 1.0);
  reader.Field("near_cells", near_cells, 0.0, 1e6);
  reader.Field("lapse_probability", lapse_probability, 0.0, 1.0);
  reader.Field("guess_probability", guess_probability, 0.0, 1.0);
  reader.Field("edit_limit", edit_limit, 0, 1000);
  reader.Choice("mechanism", mechanism, kReadingMechanisms);
  reader.Field("rate", rate, 0.0, 1.0);
  reader.Field("amount", amount, -1.0, 1000.0);
}

std::vector<Cell> NoticedGoals(const SnapshotReaderParameters& parameters, const Snapshot& snapshot,
                               const std::vector<Cell>& goals, Random& random) {
  std::vector<Cell> noticed;
  if (random.Chance(parameters.lapse_probability)) return noticed;
  for (const Cell goal : goals) {
    if (!Contains(snapshot.visible.free, goal)) continue;
    const double distance =
        std::hypot(goal.row - snapshot.cell.row, goal.column - snapshot.cell.column);
    const double chance =
        parameters.edit_probability * std::exp(-distance / parameters.decay_cells);
    if (random.Chance(chance)) noticed.push_back(goal);
  }
  return noticed;
}

}  // namespace conav::operators
