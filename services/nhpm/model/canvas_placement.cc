#include "nhpm/model/canvas_placement.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/runtime/result.h"

namespace conav::nhpm {
namespace {

/// A number in [low, high), or `low` if there is none.
double Between(double low, double high, Random& random) {
  return low + std::max(high - low, 0.0) * random.Unit();
}

bool OnCanvas(Cell pixel, int canvas) {
  return pixel.row >= 0 && pixel.column >= 0 && pixel.row < canvas && pixel.column < canvas;
}

Cell PixelOfCell(const Placement& p, int rows, int columns, Cell cell) {
  const double north = rows / 2.0 - (cell.row + 0.5);
  const double east = (p.mirrored ? -1.0 : 1.0) * (cell.column + 0.5 - columns / 2.0);
  const double cosine = std::cos(p.angle_rad);
  const double sine = std::sin(p.angle_rad);
  const double row = p.centre_row - p.scale * (east * sine + north * cosine);
  const double column = p.centre_column + p.scale * (east * cosine - north * sine);
  return {static_cast<int>(std::floor(row)), static_cast<int>(std::floor(column))};
}

}  // namespace

Placement DrawPlacement(int canvas, int rows, int columns, Cell camera, Random& random) {
  for (;;) {
    Placement placement{.canvas = canvas};
    const auto side = static_cast<double>(random.Uniform((2 * canvas + 2) / 3, canvas));
    placement.scale = side / std::max(rows, columns);
    placement.angle_rad = 2.0 * std::numbers::pi * random.Unit();
    placement.mirrored = random.Chance(0.5);
    placement.centre_row = Between(side / 2.0, canvas - side / 2.0, random);
    placement.centre_column = Between(side / 2.0, canvas - side / 2.0, random);
    if (OnCanvas(PixelOfCell(placement, rows, columns, camera), canvas)) return placement;
  }
}

CanvasMap::CanvasMap(const Placement& placement, int rows, int columns)
    : placement_(placement),
      rows_(rows),
      columns_(columns),
      cosine_(std::cos(placement.angle_rad)),
      sine_(std::sin(placement.angle_rad)) {
  const int canvas = placement_.canvas;
  sources_.reserve(static_cast<std::size_t>(canvas) * static_cast<std::size_t>(canvas));
  for (int row = 0; row < canvas; ++row) {
    const double up = (placement_.centre_row - (row + 0.5)) / placement_.scale;
    for (int column = 0; column < canvas; ++column) {
      const double right = (column + 0.5 - placement_.centre_column) / placement_.scale;
      const double turned = right * cosine_ + up * sine_;
      const double east = placement_.mirrored ? -turned : turned;
      const double north = up * cosine_ - right * sine_;
      const int r = static_cast<int>(std::floor(rows_ / 2.0 - north));
      const int c = static_cast<int>(std::floor(columns_ / 2.0 + east));
      const bool inside = r >= 0 && c >= 0 && r < rows_ && c < columns_;
      sources_.push_back(inside ? r * columns_ + c : -1);
    }
  }
}

Cell CanvasMap::PixelOf(Cell cell) const { return PixelOfCell(placement_, rows_, columns_, cell); }

double CanvasMap::HeadingOf(double heading_rad) const {
  const double mirrored = placement_.mirrored ? std::numbers::pi - heading_rad : heading_rad;
  return mirrored + placement_.angle_rad;
}

PerceptionQuery CanvasMap::Paste(const PerceptionQuery& query) const {
  DEMAND(query.belief.rows() == rows_ && query.belief.columns() == columns_, query.belief.rows(),
         query.belief.columns(), rows_, columns_);
  PerceptionQuery pasted;
  pasted.belief = Paste(query.belief, 1.0F);
  pasted.cell = PixelOf(query.cell);
  pasted.heading_rad = HeadingOf(query.heading_rad);
  DEMAND(OnCanvas(pasted.cell, placement_.canvas), query.cell.row, query.cell.column);
  const auto paste = [&](const std::vector<Cell>& cells, std::vector<Cell>& pixels) {
    Grid<std::uint8_t> mask(rows_, columns_);
    for (const Cell cell : cells) mask[cell] = 1;
    for (std::size_t i = 0; i < sources_.size(); ++i) {
      if (sources_[i] < 0 || mask.values()[static_cast<std::size_t>(sources_[i])] == 0) continue;
      pixels.push_back(pasted.belief.CellAt(i));
    }
  };
  paste(query.path, pasted.path);
  paste(query.visible.free, pasted.visible.free);
  paste(query.visible.walls, pasted.visible.walls);
  return pasted;
}

}  // namespace conav::nhpm
