#pragma once

#include <functional>
#include <span>
#include <string_view>

#include "common/grid/grid.h"
#include "common/plot/svg.h"

namespace conav {

/// Attributes of the cells of a map.
struct CellStyles {
  std::string_view wall = "fill=\"#4a4a4a\"";
  std::string_view free = "fill=\"#f4f4f4\"";
  std::string_view unknown = "fill=\"#c8c8c8\"";
};

/// Shape of an arrow head, in cells from its base point.
struct ArrowShape {
  double length = 0.75;
  double half_width = 0.3;
};

/// Draws a grid map on a canvas. Lengths are in cells. Cells below kRasterPixels have no gap between
/// them, and equal neighbours in a row are one element of the document.
class MapPanel {
 public:
  /// `corner` is the north-western one. `canvas` outlives the panel.
  MapPanel(SvgCanvas& canvas, PixelPosition corner, double cell_pixels)
      : canvas_(canvas), corner_(corner), cell_pixels_(cell_pixels) {}

  PixelPosition Corner(Cell cell) const {
    return {corner_.x + cell.column * cell_pixels_, corner_.y + cell.row * cell_pixels_};
  }
  PixelPosition Middle(Cell cell) const {
    return {corner_.x + (cell.column + 0.5) * cell_pixels_,
            corner_.y + (cell.row + 0.5) * cell_pixels_};
  }

  static constexpr double kRasterPixels = 8.0;

  /// Leaves a gap of one pixel to the next cell.
  void DrawCell(Cell cell, std::string_view style) const;
  void DrawMap(const OccupancyGrid& map, const CellStyles& styles = {}) const;
  /// A cell is a wall from kWallThreshold on; none is unknown.
  void DrawMap(const BeliefGrid& map, const CellStyles& styles = {}) const;
  /// Cell by cell; `style_of` gives an empty style for a cell that stays as it is.
  void DrawCells(int rows, int columns,
                 const std::function<std::string_view(Cell)>& style_of) const;
  /// From centre to centre. `shift_pixels`, right and down, keeps several paths apart.
  void DrawPath(std::span<const Cell> cells, std::string_view style,
                double shift_pixels = 0.0) const;
  /// `heading_rad` as on the map: 0 east, counter-clockwise.
  void DrawArrow(PixelPosition from, double heading_rad, const ArrowShape& shape,
                 std::string_view style) const;
  void DrawCross(PixelPosition middle, double reach, std::string_view style) const;
  void DrawRing(PixelPosition middle, double radius, std::string_view style) const;
  /// With five points.
  void DrawStar(PixelPosition middle, std::string_view style) const;

 private:
  SvgCanvas& canvas_;
  PixelPosition corner_;
  double cell_pixels_;
};

}  // namespace conav
