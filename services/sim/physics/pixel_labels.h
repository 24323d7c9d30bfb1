#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "common/grid/grid.h"
#include "sim/physics/camera.h"

namespace conav::sim {

/// Where a camera is and how it projects, taken from MuJoCo after its kinematics.
struct Projection {
  double position[3] = {};
  double rotation[9] = {};  // row-major; columns are image right, image up, backwards
  double tan_half_height = 0.0;
  int width = 0;
  int height = 0;
};

/// Turns MuJoCo's geom ids into what they stand for. A wall or floor geom spans many cells; the
/// cell of a pixel is where its ray meets the geom's plane.
class PixelLabeler {
 public:
  explicit PixelLabeler(const RobotWorld& world);

  /// `geoms`: one model geom id per pixel, -1 for none; row 0 is the upper row.
  Grid<PixelLabel> Label(const Projection& projection, std::span<const int> geoms) const;

 private:
  struct GeomLabel {
    PixelKind kind = PixelKind::kNone;
    int index = -1;
  };
  Cell CellOf(int geom, PixelKind kind, const double* origin, const double* direction) const;

  const RobotWorld& world_;
  std::vector<GeomLabel> labels_;  // by geom id
};

}  // namespace conav::sim
