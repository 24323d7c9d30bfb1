#pragma once

#include <string>
#include <vector>

#include "common/grid/grid.h"
#include "sim/physics/world_model.h"

namespace conav::sim {

/// A block of cells of one class.
struct CellRectangle {
  Cell north_west;
  int rows = 1;
  int columns = 1;
  char cell_class = 0;
};

/// A straight run of wall faces: `length` wall cells from `first` (to the east or to the south),
/// each with a free cell on the side `normal` (one of kNeighbourOffsets).
struct FaceRun {
  Cell first;
  Cell normal;
  int length = 1;
  char cell_class = 0;
};

/// Class of a cell that stays uncovered.
inline constexpr char kNoClass = 0;

/// MuJoCo centres a texture on its plane, so only odd sides show whole tiles.
enum class Sides { kAny, kOdd };

/// Covers all cells whose class is not kNoClass with rectangles of one class each, without overlap:
/// scan row-major, extend right, then down.
std::vector<CellRectangle> CoverWithRectangles(const Grid<char>& classes, Sides sides);

/// The faces between wall cells (class not kNoClass) and free cells inside the grid; lengths are
/// odd.
std::vector<FaceRun> ExposedFaces(const Grid<char>& wall_classes);

/// Geom groups: which camera draws what.
inline constexpr int kVisibleGroup = 0;
inline constexpr int kCollisionGroup = 3;  // never drawn
inline constexpr int kHiddenGroup = 5;     // reached goals

/// Names inside the model. Robots and goals are named by index, so any robot name is legal.
std::string RobotElement(int robot, const char* part);  // "robot3/steer"
std::string GoalElement(int goal);                      // "goal2"
std::string DoorElement(int door, int part);            // "door2/0": its box; 1 to 4: its faces
inline constexpr int kDoorParts = 5;
inline constexpr double kOpenDoorM = -100.0;  // height of the box of a door that is open
std::string WallTextureName(int texture);
std::string FloorTextureName(int texture);
/// How many floor textures the model has.
int FloorTextures(const PhysicsWorld& world);

/// The height field of open terrain: one node in the middle of each cell. Between land and water it
/// falls so steeply that no land reaches out of the occupied cells.
inline constexpr double kTerrainTopM = 6.0;
inline constexpr double kTerrainBedM = -54.0;
double TerrainHeight(const PhysicsWorld& world, Cell cell);

/// The model's MJCF text. Textures are declared flat and the
/// height field empty; BuildModel fills them in.
/// Requires CheckWorld(world).
std::string WriteMjcf(const PhysicsWorld& world);

}  // namespace conav::sim
