#include "sim/physics/textures.h"

#include <algorithm>
#include <cmath>

#include "common/runtime/random.h"
#include "common/runtime/result.h"

namespace conav::sim {
namespace {

constexpr int kSize = kTextureSize;

/// A square image, painted with a base colour times a brightness.
class Painter {
 public:
  Painter(Rgb base, std::span<std::uint8_t> rgb) : base_(base), rgb_(rgb) {
    DEMAND(rgb.size() == static_cast<std::size_t>(kSize) * kSize * 3, rgb.size());
    Fill(0, 0, kSize, kSize, 1.0);
  }

  void Set(int x, int y, double brightness) {
    const auto at = (static_cast<std::size_t>(y) * kSize + static_cast<std::size_t>(x)) * 3;
    rgb_[at] = Scale(base_.red, brightness);
    rgb_[at + 1] = Scale(base_.green, brightness);
    rgb_[at + 2] = Scale(base_.blue, brightness);
  }

  /// Clipped to the image.
  void Fill(int x, int y, int width, int height, double brightness) {
    for (int row = std::max(y, 0); row < std::min(y + height, kSize); ++row) {
      for (int column = std::max(x, 0); column < std::min(x + width, kSize); ++column) {
        Set(column, row, brightness);
      }
    }
  }

 private:
  static std::uint8_t Scale(std::uint8_t value, double brightness) {
    return static_cast<std::uint8_t>(std::clamp(std::lround(value * brightness), 0L, 255L));
  }

  Rgb base_;
  std::span<std::uint8_t> rgb_;
};

/// A thin trace of a few horizontal and vertical legs, ending in a pad.
void DrawTrace(Painter& painter, Random& random) {
  int x = static_cast<int>(random.Uniform(16, kSize - 17));
  int y = static_cast<int>(random.Uniform(40, kSize - 40));
  for (int leg = 0; leg < 3; ++leg) {
    const int length = static_cast<int>(random.Uniform(12, 60));
    const int sign = random.Chance(0.5) ? 1 : -1;
    if (leg % 2 == 0) {
      const int end = std::clamp(x + sign * length, 12, kSize - 13);
      painter.Fill(std::min(x, end), y, std::abs(end - x) + 2, 2, 0.35);
      x = end;
    } else {
      const int end = std::clamp(y + sign * length, 36, kSize - 30);
      painter.Fill(x, std::min(y, end), 2, std::abs(end - y) + 2, 0.35);
      y = end;
    }
  }
  painter.Fill(x - 3, y - 3, 7, 7, 0.5);
}

// Seven hexagon columns and eight half-shifted rows tile the square without a seam.
constexpr int kTileColumns = 7;
constexpr int kTileRows = 8;

struct NearestTile {
  int row = 0;
  int column = 0;
  double edge_px = 0.0;  // second nearest distance minus nearest: 0 on an edge
};

/// The tile with the nearest centre: hexagons are the Voronoi cells of a shifted lattice.
NearestTile FindTile(double x, double y) {
  constexpr double kWidth = static_cast<double>(kSize) / kTileColumns;
  constexpr double kHeight = static_cast<double>(kSize) / kTileRows;
  NearestTile tile;
  double nearest = 1e9;
  double second = 1e9;
  const int middle_row = static_cast<int>(std::floor(y / kHeight));
  for (int row = middle_row - 1; row <= middle_row + 1; ++row) {
    const int wrapped_row = (row + kTileRows) % kTileRows;
    const double shift = wrapped_row % 2 == 0 ? 0.25 : 0.75;
    const int west = static_cast<int>(std::floor(x / kWidth - shift));
    for (int column = west; column <= west + 1; ++column) {
      const double distance = std::hypot(x - (column + shift) * kWidth, y - (row + 0.5) * kHeight);
      if (distance < nearest) {
        second = nearest;
        nearest = distance;
        tile.row = wrapped_row;
        tile.column = (column + kTileColumns) % kTileColumns;
      } else {
        second = std::min(second, distance);
      }
    }
  }
  tile.edge_px = second - nearest;
  return tile;
}

}  // namespace

void DrawWallTexture(Rgb base, int variant, std::span<std::uint8_t> rgb) {
  Painter painter(base, rgb);
  Random random(DeriveSeed(17, static_cast<std::uint64_t>(variant)));
  for (int panel = 0; panel < 6; ++panel) {
    const int x = static_cast<int>(random.Uniform(8, kSize - 70));
    const int y = static_cast<int>(random.Uniform(36, kSize - 80));
    const int width = static_cast<int>(random.Uniform(24, 60));
    const int height = static_cast<int>(random.Uniform(20, 50));
    painter.Fill(x, y, width, height, panel % 2 == 0 ? 1.14 : 0.88);
  }
  for (int trace = 0; trace < 9; ++trace) DrawTrace(painter, random);
  painter.Fill(0, kSize - 26, kSize, 26, 0.45);
  for (int x = 4; x < kSize; x += 16) painter.Fill(x, kSize - 20, 8, 14, 0.25);  // comb
  painter.Fill(0, 0, kSize, 18, 1.3);
  painter.Fill(0, 0, 5, kSize, 0.3);
  painter.Fill(kSize - 5, 0, 5, kSize, 0.3);
}

void DrawFloorTexture(Rgb base, int variant, std::span<std::uint8_t> rgb) {
  Painter painter(base, rgb);
  Random random(DeriveSeed(29, static_cast<std::uint64_t>(variant)));
  double shades[kTileRows][kTileColumns];
  for (auto& row : shades) {
    for (double& shade : row) shade = random.Chance(0.12) ? 0.72 : 0.94 + 0.12 * random.Unit();
  }
  for (int y = 0; y < kSize; ++y) {
    for (int x = 0; x < kSize; ++x) {
      const NearestTile tile = FindTile(x + 0.5, y + 0.5);
      painter.Set(x, y, tile.edge_px < 2.5 ? 0.6 : shades[tile.row][tile.column]);
    }
  }
}

}  // namespace conav::sim
