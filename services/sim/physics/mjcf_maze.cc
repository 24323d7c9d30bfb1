#include <map>
#include <vector>

#include "common/runtime/random.h"
#include "sim/physics/covering.h"
#include "sim/physics/mjcf.h"
#include "sim/physics/mjcf_writer.h"
#include "sim/physics/textures.h"

namespace conav::sim {
namespace {

/// Wall classes: the given one, or one class for all; kNoClass where the cell is free.
Grid<char> WallClasses(const PhysicsWorld& world) {
  Grid<char> classes(world.truth.rows(), world.truth.columns(), kNoClass);
  for (std::size_t i = 0; i < classes.size(); ++i) {
    if (world.truth.values()[i] != Occupancy::kOccupied) continue;
    const char given = world.wall_classes.size() == 0 ? '*' : world.wall_classes.values()[i];
    classes.values()[i] = given == kNoClass ? '*' : given;
  }
  return classes;
}

constexpr char kCorridorFloor = 'c';
constexpr char kRoomFloor = 'r';

/// Floor classes; kNoClass under walls.
Grid<char> FloorClasses(const PhysicsWorld& world) {
  Grid<char> classes(world.truth.rows(), world.truth.columns(), kNoClass);
  for (std::size_t i = 0; i < classes.size(); ++i) {
    if (world.truth.values()[i] == Occupancy::kOccupied) continue;
    const char given = world.floor_classes.size() == 0 ? '.' : world.floor_classes.values()[i];
    classes.values()[i] =
        given == '.' || given == ' ' || given == kNoClass ? kCorridorFloor : kRoomFloor;
  }
  return classes;
}

/// Middle of a rectangle of cells.
Position Middle(const GridGeometry& geometry, Cell north_west, int rows, int columns) {
  const Position corner = geometry.CellToPosition(north_west);
  return {corner.x_m + (columns - 1) * geometry.cell_size_m / 2.0,
          corner.y_m - (rows - 1) * geometry.cell_size_m / 2.0};
}

/// A texture for every wall class: the shuffled textures in the order of the classes' characters.
std::map<char, int> AssignTextures(const Grid<char>& classes, std::uint64_t seed) {
  std::map<char, int> textures;
  for (const char cell_class : classes.values()) {
    if (cell_class != kNoClass) textures[cell_class] = 0;
  }
  std::vector<int> order;
  for (int i = 0; i < kWallTextureCount; ++i) order.push_back(i);
  Random random(DeriveSeed(seed, 0x7e57));
  random.Shuffle(order);
  std::size_t next = 0;
  for (auto& [cell_class, texture] : textures) texture = order[next++ % order.size()];
  return textures;
}

void WriteWallFace(MjcfWriter& out, const GridGeometry& geometry, const FaceRun& run, int texture) {
  const bool along_row = run.normal.row != 0;
  const Position middle =
      Middle(geometry, run.first, along_row ? 1 : run.length, along_row ? run.length : 1);
  const int east = run.normal.column;
  const int north = -run.normal.row;
  const double half_cell = geometry.cell_size_m / 2.0;
  // Local z is the face's normal, y is up, x = y cross z.
  out.Line(R"(<geom type="plane" size="{:.9g} {:.9g} 1" pos="{:.9g} {:.9g} {:.9g}")"
           R"( xyaxes="{} {} 0 0 0 1" material="{}"/>)",
           run.length * half_cell, kWallHeightM / 2.0, middle.x_m + east * half_cell,
           middle.y_m + north * half_cell, kWallHeightM / 2.0, -north, east,
           WallTextureName(texture));
}

void WriteWallFaces(MjcfWriter& out, const GridGeometry& geometry, const Grid<char>& classes,
                    std::uint64_t texture_seed) {
  const std::map<char, int> textures = AssignTextures(classes, texture_seed);
  for (const FaceRun& run : ExposedFaces(classes)) {
    WriteWallFace(out, geometry, run, textures.at(run.cell_class));
  }
  const double half_cell = geometry.cell_size_m / 2.0;
  for (const CellRectangle& block : CoverWithRectangles(classes, Sides::kAny)) {
    const Position middle = Middle(geometry, block.north_west, block.rows, block.columns);
    out.Line(R"(<geom type="plane" size="{:.9g} {:.9g} 1" pos="{:.9g} {:.9g} {}" group="{}")"
             R"( rgba="{}"/>)",
             block.columns * half_cell, block.rows * half_cell, middle.x_m, middle.y_m,
             kWallHeightM, kTopGroup, Rgba(kWallColors[textures.at(block.cell_class)]));
  }
}

void WriteFloor(MjcfWriter& out, const GridGeometry& geometry, const Grid<char>& classes) {
  const double half_cell = geometry.cell_size_m / 2.0;
  for (const CellRectangle& block : CoverWithRectangles(classes, Sides::kOdd)) {
    const Position middle = Middle(geometry, block.north_west, block.rows, block.columns);
    out.Line(R"(<geom type="plane" size="{:.9g} {:.9g} 1" pos="{:.9g} {:.9g} 0" material="{}"/>)",
             block.columns * half_cell, block.rows * half_cell, middle.x_m, middle.y_m,
             FloorTextureName(block.cell_class == kRoomFloor ? 1 : 0));
  }
}

void WriteGoals(MjcfWriter& out, const PhysicsWorld& world, const GridGeometry& geometry) {
  for (std::size_t i = 0; i < world.goals.size(); ++i) {
    const Position at = geometry.CellToPosition(world.goals[i].cell);
    out.Line(
        R"(<geom name="{}" type="sphere" size="{:.9g}" pos="{:.9g} {:.9g} 0" rgba="{}"/>)",
        GoalElement(static_cast<int>(i)), GoalRadius(world.cell_size_m), at.x_m, at.y_m,
        Rgba(kGoalColors[static_cast<unsigned>(world.goals[i].color_index) % kGoalColorCount]));
  }
}

std::string BoxName(int box) { return fmt::format("box{}", box); }

/// One box per rectangle of walls, of any class, and the ground. Returns the number of boxes.
int WriteCollisionGeoms(MjcfWriter& out, const GridGeometry& geometry, Grid<char> classes) {
  for (char& cell_class : classes.values()) cell_class = cell_class == kNoClass ? kNoClass : '*';
  out.Line(R"(<geom name="ground" type="plane" size="0 0 1" group="{}"/>)", kCollisionGroup);
  const double half_cell = geometry.cell_size_m / 2.0;
  int boxes = 0;
  for (const CellRectangle& block : CoverWithRectangles(classes, Sides::kAny)) {
    const Position middle = Middle(geometry, block.north_west, block.rows, block.columns);
    out.Line(R"(<geom name="{}" type="box" size="{:.9g} {:.9g} {:.9g}" pos="{:.9g} {:.9g} {:.9g}")"
             R"( group="{}"/>)",
             BoxName(boxes++), block.columns * half_cell, block.rows * half_cell,
             kWallHeightM / 2.0, middle.x_m, middle.y_m, kWallHeightM / 2.0, kCollisionGroup);
  }
  return boxes;
}

}  // namespace

int WriteMaze(MjcfWriter& out, const PhysicsWorld& world) {
  const GridGeometry geometry{world.truth.rows(), world.truth.columns(), world.cell_size_m};
  const Grid<char> walls = WallClasses(world);
  const int boxes = WriteCollisionGeoms(out, geometry, walls);
  out.Line(R"(<body name="scenery" childclass="scenery">)");
  out.Line(R"(<inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/>)");  // planes have no mass
  WriteWallFaces(out, geometry, walls, world.texture_seed);
  WriteFloor(out, geometry, FloorClasses(world));
  WriteGoals(out, world, geometry);
  out.Line("</body>");
  return boxes;
}

void WriteContacts(MjcfWriter& out, int robot, int boxes) {
  const std::string shell = RobotElement(robot, "shell");
  // Two sliding directions, torsion, two rolling directions (unused in four dimensions): the larger
  // of the two geoms' coefficients, MuJoCo's 1 for scenery and MemoryMaze's .5/.02/.02 for robots.
  const auto pair = [&](const std::string& other, double sliding) {
    out.Line(R"(<pair geom1="{}" geom2="{}" condim="4" friction="{} {} .02 .02 .02"/>)", other,
             shell, sliding, sliding);
  };
  pair("ground", 1.0);
  for (int box = 0; box < boxes; ++box) pair(BoxName(box), 1.0);
  for (int other = 0; other < robot; ++other) pair(RobotElement(other, "shell"), 0.5);
}

}  // namespace conav::sim
