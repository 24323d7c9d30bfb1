#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "common/msg/planning.h"
#include "common/runtime/random.h"

/// Maze maps pasted on a square canvas, so that a network for rasters can learn from them.
namespace conav::nhpm {

inline constexpr int kPaperCanvas = 150;

/// How a map lies on a canvas. Mirrored first (west and east swapped), then turned, then scaled.
struct Placement {
  int canvas = kPaperCanvas;  // rows and columns, in pixels
  double scale = 10.0;        // pixels per cell
  double angle_rad = 0.0;     // counter-clockwise
  bool mirrored = false;
  double centre_row = 75.0;  // of the map, in pixels from the canvas's north-west corner
  double centre_column = 75.0;
};

/// A placement of a rows x columns map as paper section 6.3 augments: its longer side 2/3 to 1 of the
/// canvas (100 to 150 pixels), any angle, mirrored or not, and anywhere where it would fit unturned;
/// corners may then lie outside of the canvas. Draws until the camera's pixel is on the canvas.
Placement DrawPlacement(int canvas, int rows, int columns, Cell camera, Random& random);

/// Where the cells of a rows x columns map are on the canvas. A pixel has the values of the cell in
/// which its centre lies (nearest neighbour).
class CanvasMap {
 public:
  CanvasMap(const Placement& placement, int rows, int columns);

  /// For each pixel, row-major, the index of its cell, or -1 outside of the map.
  std::span<const std::int32_t> sources() const { return sources_; }
  /// The pixel of the cell's centre; may lie outside of the canvas.
  Cell PixelOf(Cell cell) const;
  double HeadingOf(double heading_rad) const;

  /// `values` on the canvas, and `outside` around them.
  template <class T>
  Grid<T> Paste(const Grid<T>& values, T outside) const {
    Grid<T> canvas(placement_.canvas, placement_.canvas, outside);
    for (std::size_t i = 0; i < sources_.size(); ++i) {
      if (sources_[i] >= 0) {
        canvas.values()[i] = values.values()[static_cast<std::size_t>(sources_[i])];
      }
    }
    return canvas;
  }

  /// The query on the canvas: masks by nearest neighbour, so that a path is as wide as a cell; walls
  /// around the map. The camera's pixel must be on the canvas (demanded).
  PerceptionQuery Paste(const PerceptionQuery& query) const;

 private:
  Placement placement_;
  int rows_;
  int columns_;
  double cosine_;
  double sine_;
  std::vector<std::int32_t> sources_;
};

}  // namespace conav::nhpm
