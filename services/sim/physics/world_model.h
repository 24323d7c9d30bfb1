#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "common/grid/geometry.h"
#include "common/grid/grid.h"
#include "common/runtime/result.h"

struct mjModel_;

namespace conav::sim {

struct RobotSpec {
  std::string name;
  Cell start;
  double heading_rad = 0.0;  // 0 = east, counter-clockwise
};

/// A coloured half-sphere on the floor, visible but not solid.
struct GoalSpec {
  Cell cell;
  int color_index = 0;  // into kGoalColors, modulo its size
};

/// The input of the physics. Frame and units: GridGeometry's map frame, metres.
///
/// In open terrain all obstacles are one height field: land on water where `heights` are given,
/// else walls on a floor. Its shores and walls lie within the occupied cells, a little behind their
/// edges.
struct PhysicsWorld {
  OccupancyGrid truth;  // no kUnknown; 1x1 to kMaxCellsPerSide squared
  bool open = false;
  Grid<float> heights;             // of land above the water; only in open terrain
  double robot_radius_m = 0.2;     // its size in a maze; others in open terrain
  double top_speed_mps = 2.0;      // at most kTopSpeedMps
  Grid<char> wall_classes;         // one texture per character; empty (0x0): all walls look alike
  Grid<char> floor_classes;        // '.' or ' ' is a corridor, others a room; empty: all corridor
  double cell_size_m = 2.0;        // in a maze at least kMinCellSizeM: the robot's size is fixed
  std::uint64_t texture_seed = 0;  // which wall class gets which texture
  std::vector<RobotSpec> robots;   // at least one, on different free cells, with different names
  std::vector<GoalSpec> goals;     // on free cells
  std::vector<Cell> doors;         // free cells that may become walls; not in open terrain
};

inline constexpr double kMinCellSizeM = 1.0;
inline constexpr double kMinOpenCellSizeM = 0.1;
inline constexpr int kMaxCellsPerSide = 1024;
inline constexpr double kBallRadiusM = 0.2;
inline constexpr double kTopSpeedMps = 2.0;
inline constexpr int kMaxRobots = 128;
inline constexpr double kWallHeightM = 1.5;
inline constexpr double kGoalRadiusM = 0.6;  // see GoalRadius
inline constexpr double kPhysicsStepS = 0.005;
inline constexpr int kSubsteps = 50;  // per low-level control step (4 Hz)
inline constexpr double kControlStepS = kPhysicsStepS * kSubsteps;

struct Rgb {
  std::uint8_t red = 0;
  std::uint8_t green = 0;
  std::uint8_t blue = 0;
};

/// Red, green, blue, purple, yellow, salmon. Source: MemoryMaze's targets.
inline constexpr Rgb kGoalColors[] = {{170, 38, 30},  {99, 170, 88},  {39, 140, 217},
                                      {93, 105, 199}, {220, 193, 59}, {220, 128, 107}};
inline constexpr int kGoalColorCount = 6;

/// 0.6 m, or 0.3 cells in a maze with cells under 2 m.
double GoalRadius(const PhysicsWorld& world);

struct ModelDeleter {
  void operator()(mjModel_* model) const;
};
using ModelPtr = std::unique_ptr<mjModel_, ModelDeleter>;

/// Reports the first error of `world` (kInvalidArgument or kOutOfRange).
Result<void> CheckWorld(const PhysicsWorld& world);

/// The MuJoCo model of a checked world, textures filled in. Fails (kInvalidArgument) with the text
/// of CheckWorld or of MuJoCo's compiler.
Result<ModelPtr> BuildModel(const PhysicsWorld& world);

}  // namespace conav::sim
