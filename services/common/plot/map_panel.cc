#include "common/plot/map_panel.h"

#include <fmt/core.h>

#include <cmath>
#include <numbers>

#include "common/grid/map_accuracy.h"

namespace conav {

void MapPanel::DrawCell(Cell cell, std::string_view style) const {
  canvas_.Rectangle(Corner(cell), cell_pixels_ - 1, cell_pixels_ - 1, style);
}

void MapPanel::DrawCells(int rows, int columns,
                         const std::function<std::string_view(Cell)>& style_of) const {
  const bool is_raster = cell_pixels_ < kRasterPixels;
  const double gap = is_raster ? 0.0 : 1.0;
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns;) {
      const std::string_view style = style_of({row, column});
      int end = column + 1;
      while (is_raster && end < columns && style_of({row, end}) == style) ++end;
      if (!style.empty()) {
        // Else background would shine through between the rows.
        const std::string crisp = fmt::format("{} shape-rendering=\"crispEdges\"", style);
        canvas_.Rectangle(Corner({row, column}), (end - column) * cell_pixels_ - gap,
                          cell_pixels_ - gap, is_raster ? std::string_view(crisp) : style);
      }
      column = end;
    }
  }
}

void MapPanel::DrawMap(const OccupancyGrid& map, const CellStyles& styles) const {
  DrawCells(map.rows(), map.columns(), [&](Cell cell) {
    return map[cell] == Occupancy::kOccupied ? styles.wall
           : map[cell] == Occupancy::kFree   ? styles.free
                                             : styles.unknown;
  });
}

void MapPanel::DrawMap(const BeliefGrid& map, const CellStyles& styles) const {
  DrawCells(map.rows(), map.columns(),
            [&](Cell cell) { return map[cell] >= kWallThreshold ? styles.wall : styles.free; });
}

void MapPanel::DrawPath(std::span<const Cell> cells, std::string_view style,
                        double shift_pixels) const {
  std::vector<PixelPosition> line;
  for (const Cell cell : cells) {
    const PixelPosition middle = Middle(cell);
    line.push_back({middle.x + shift_pixels, middle.y + shift_pixels});
  }
  canvas_.Polyline(line, style);
}

void MapPanel::DrawArrow(PixelPosition from, double heading_rad, const ArrowShape& shape,
                         std::string_view style) const {
  const double x = std::cos(heading_rad);
  const double y = -std::sin(heading_rad);  // pixels run down, the map's y runs up
  const double length = shape.length * cell_pixels_;
  const double half_width = shape.half_width * cell_pixels_;
  canvas_.Polygon({{from.x + x * length, from.y + y * length},
                   {from.x - y * half_width, from.y + x * half_width},
                   {from.x + y * half_width, from.y - x * half_width}},
                  style);
}

void MapPanel::DrawCross(PixelPosition middle, double reach, std::string_view style) const {
  canvas_.Cross(middle, reach * cell_pixels_, style);
}

void MapPanel::DrawRing(PixelPosition middle, double radius, std::string_view style) const {
  canvas_.Circle(middle, radius * cell_pixels_, style);
}

void MapPanel::DrawStar(PixelPosition middle, std::string_view style) const {
  std::vector<PixelPosition> corners;
  for (int i = 0; i < 10; ++i) {
    const double radius = cell_pixels_ * (i % 2 == 0 ? 0.42 : 0.18);
    const double angle = (i * 36.0 - 90.0) * std::numbers::pi / 180.0;
    corners.push_back({middle.x + radius * std::cos(angle), middle.y + radius * std::sin(angle)});
  }
  canvas_.Polygon(corners, style);
}

}  // namespace conav
