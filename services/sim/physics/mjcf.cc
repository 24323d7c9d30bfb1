#include "sim/physics/mjcf.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <map>
#include <numbers>
#include <utility>

#include "common/grid/visibility.h"
#include "common/runtime/random.h"
#include "sim/physics/robot_body.h"
#include "sim/physics/textures.h"

namespace conav::sim {
namespace {

int MakeOdd(int length) { return length % 2 == 0 ? length - 1 : length; }

/// Number of cells from `start` along `step` for which `matches` holds.
template <class Matches>
int RunLength(Cell start, Cell step, Matches&& matches) {
  int length = 0;
  for (Cell cell = start; matches(cell); cell = cell + step) ++length;
  return length;
}

}  // namespace

std::vector<CellRectangle> CoverWithRectangles(const Grid<char>& classes, Sides sides) {
  std::vector<CellRectangle> rectangles;
  Grid<char> left = classes;
  for (std::size_t i = 0; i < left.size(); ++i) {
    const char cell_class = left.values()[i];
    if (cell_class == kNoClass) continue;
    const Cell corner = left.CellAt(i);
    const auto matches = [&](Cell cell) { return left.Contains(cell) && left[cell] == cell_class; };
    int columns = RunLength(corner, {0, 1}, matches);
    if (sides == Sides::kOdd) columns = MakeOdd(columns);
    int rows = RunLength(corner, {1, 0}, [&](Cell row) {
      return RunLength(row, {0, 1}, matches) >= columns;
    });
    if (sides == Sides::kOdd) rows = MakeOdd(rows);
    for (int r = 0; r < rows; ++r) {
      for (int c = 0; c < columns; ++c) left[corner + Cell{r, c}] = kNoClass;
    }
    rectangles.push_back({corner, rows, columns, cell_class});
  }
  return rectangles;
}

std::vector<FaceRun> ExposedFaces(const Grid<char>& wall_classes) {
  std::vector<FaceRun> runs;
  for (const Cell normal : kNeighbourOffsets) {
    Grid<char> exposed(wall_classes.rows(), wall_classes.columns(), kNoClass);
    for (std::size_t i = 0; i < exposed.size(); ++i) {
      const Cell cell = exposed.CellAt(i);
      const Cell front = cell + normal;
      if (exposed.Contains(front) && wall_classes[front] == kNoClass) {
        exposed[cell] = wall_classes[cell];
      }
    }
    const Cell along = normal.row != 0 ? Cell{0, 1} : Cell{1, 0};
    for (std::size_t i = 0; i < exposed.size(); ++i) {
      const char cell_class = exposed.values()[i];
      if (cell_class == kNoClass) continue;
      const Cell first = exposed.CellAt(i);
      const int length = MakeOdd(RunLength(first, along, [&](Cell cell) {
        return exposed.Contains(cell) && exposed[cell] == cell_class;
      }));
      Cell cell = first;
      for (int n = 0; n < length; ++n, cell = cell + along) exposed[cell] = kNoClass;
      runs.push_back({first, normal, length, cell_class});
    }
  }
  return runs;
}

std::string RobotElement(int robot, const char* part) {
  return fmt::format("robot{}/{}", robot, part);
}
std::string GoalElement(int goal) { return fmt::format("goal{}", goal); }
std::string DoorElement(int door, int part) { return fmt::format("door{}/{}", door, part); }
std::string WallTextureName(int texture) { return fmt::format("wall{}", texture); }
std::string FloorTextureName(int texture) { return fmt::format("floor{}", texture); }
int FloorTextures(const PhysicsWorld& world) {
  return world.heights.size() == 0 ? kMazeFloorTextureCount : kFloorTextureCount;
}

double TerrainHeight(const PhysicsWorld& world, Cell cell) {
  if (world.truth[cell] != Occupancy::kOccupied) return kTerrainBedM;
  if (world.heights.size() == 0) return kWallHeightM;
  return kWallHeightM + std::clamp(double{world.heights[cell]}, 0.0, kTerrainTopM - kWallHeightM);
}

namespace {

/// Collects MJCF text line by line. Numbers that affect physics or images have nine digits
/// ({:.9g}).
class MjcfWriter {
 public:
  template <class... Values>
  void Line(fmt::format_string<Values...> format, Values&&... values) {
    text_ += fmt::format(format, std::forward<Values>(values)...);
    text_ += '\n';
  }
  std::string Take() { return std::move(text_); }

 private:
  std::string text_;
};

/// "r g b 1" in [0, 1].
std::string Rgba(Rgb color) {
  return fmt::format("{:.4g} {:.4g} {:.4g} 1", color.red / 255.0, color.green / 255.0,
                     color.blue / 255.0);
}

void WriteGlobals(MjcfWriter& out, const PhysicsWorld& world) {
  const double extent = std::max(world.truth.rows(), world.truth.columns()) * world.cell_size_m;
  // MuJoCo's memory grows with the square of their number. A crowd touches itself and walls in fewer places
  // for each robot than a few robots may.
  const int robots = static_cast<int>(world.robots.size());
  const int contacts = 40 + 24 * std::min(robots, 8) + 6 * std::max(0, robots - 8);
  out.Line(R"(<compiler angle="radian" autolimits="true"/>)");
  out.Line(R"(<option timestep="{}" cone="elliptic" noslip_iterations="5" noslip_tolerance="0")"
           R"( collision="predefined"/>)",
           kPhysicsStepS);
  out.Line(R"(<size njmax="{}" nconmax="{}"/>)", contacts * 6, contacts);
  out.Line(R"(<statistic center="0 0 0" extent="{:.9g}"/>)", extent);
  out.Line(R"(<default><default class="scenery"><geom contype="0" conaffinity="0"/></default>)");
  out.Line(R"(</default>)");
  out.Line(R"(<visual>)");
  out.Line(R"(<headlight ambient=".45 .45 .45" diffuse=".6 .6 .6" specular="0 0 0"/>)");
  // Near plane 2 cm; far plane well beyond the diagonal.
  out.Line(R"(<map znear="{:.9g}" zfar="{:.9g}"/>)", 0.02 / extent,
           (150.0 + 2.0 * extent) / extent);
  out.Line(
      R"(<quality shadowsize="0" offsamples="4" numslices="24" numstacks="12" numquads="1"/>)");
  out.Line(R"(<global offwidth="64" offheight="64"/>)");
  out.Line(R"(</visual>)");
}

constexpr const char* kHeightField = "terrain";

void WriteAssets(MjcfWriter& out, const PhysicsWorld& world) {
  // MuJoCo counts texture repeats per half unit of length here.
  const double per_cell = 2.0 / world.cell_size_m;
  out.Line("<asset>");
  out.Line(R"(<texture type="skybox" builtin="gradient" rgb1=".4 .6 .8" rgb2="0 0 0")"
           R"( width="100" height="100"/>)");
  out.Line(R"(<texture name="ball" type="cube" builtin="checker" rgb1="1 1 1" rgb2=".35 .35 .35")"
           R"( width="32" height="32"/>)");
  out.Line(R"(<material name="ball" texture="ball"/>)");
  const auto material = [&](const std::string& name, double repeats_up) {
    out.Line(
        R"(<texture name="{}" type="2d" builtin="flat" rgb1=".5 .5 .5" width="{}" height="{}"/>)",
        name, kTextureSize, kTextureSize);
    out.Line(R"(<material name="{}" texture="{}" texuniform="true" texrepeat="{:.9g} {:.9g}"/>)",
             name, name, per_cell, repeats_up);
  };
  for (int i = 0; i < kWallTextureCount; ++i) material(WallTextureName(i), 2.0 / kWallHeightM);
  for (int i = 0; i < FloorTextures(world); ++i) material(FloorTextureName(i), per_cell);
  if (world.open) {
    out.Line(R"(<hfield name="{}" nrow="{}" ncol="{}" size="{:.9g} {:.9g} {} 1"/>)", kHeightField,
             world.truth.rows(), world.truth.columns(),
             (world.truth.columns() - 1) * world.cell_size_m / 2.0,
             (world.truth.rows() - 1) * world.cell_size_m / 2.0, kTerrainTopM - kTerrainBedM);
  }
  out.Line("</asset>");
}

// The maze.

/// The wall class of each cell: the given one, or one class for all; kNoClass if the cell is free.
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

/// The floor class of each cell; kNoClass under walls.
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

/// Assigns a texture to every wall class: shuffled textures in the order of the classes'
/// characters.
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
}

/// A wall around one cell, hidden until the door closes, and its box, deep below the ground.
void WriteDoors(MjcfWriter& out, const PhysicsWorld& world, const GridGeometry& geometry) {
  for (std::size_t i = 0; i < world.doors.size(); ++i) {
    const Position at = geometry.CellToPosition(world.doors[i]);
    const double half_cell = geometry.cell_size_m / 2.0;
    for (int face = 0; face < 4; ++face) {
      const Cell normal = kNeighbourOffsets[static_cast<std::size_t>(face)];
      out.Line(R"(<geom name="{}" type="plane" size="{:.9g} {:.9g} 1" pos="{:.9g} {:.9g} {:.9g}")"
               R"( xyaxes="{} {} 0 0 0 1" material="{}" group="{}"/>)",
               DoorElement(static_cast<int>(i), 1 + face), half_cell, kWallHeightM / 2.0,
               at.x_m + normal.column * half_cell, at.y_m - normal.row * half_cell,
               kWallHeightM / 2.0, normal.row, normal.column, WallTextureName(0), kHiddenGroup);
    }
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
        GoalElement(static_cast<int>(i)), GoalRadius(world), at.x_m, at.y_m,
        Rgba(kGoalColors[static_cast<unsigned>(world.goals[i].color_index) % kGoalColorCount]));
  }
}

std::string BoxName(int box) { return fmt::format("box{}", box); }

/// The ground, and all obstacles as one height field in place of the boxes. Returns their number.
int WriteTerrain(MjcfWriter& out, const PhysicsWorld& world) {
  out.Line(R"(<geom name="ground" type="plane" size="0 0 1" group="{}"/>)", kCollisionGroup);
  const bool land = world.heights.size() != 0;
  out.Line(R"(<geom name="{}" type="hfield" hfield="{}" pos="0 0 {}" group="{}"{}/>)", BoxName(0),
           kHeightField, kTerrainBedM, land ? kVisibleGroup : kCollisionGroup,
           land ? fmt::format(R"( material="{}")", FloorTextureName(kLandTexture)) : "");
  return 1;
}

/// One box per rectangle of walls, of any class, those of the doors, and the ground. Returns the
/// number of boxes without doors.
int WriteCollisionGeoms(MjcfWriter& out, const GridGeometry& geometry, Grid<char> classes,
                        const std::vector<Cell>& doors) {
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
  for (std::size_t i = 0; i < doors.size(); ++i) {
    const Position at = geometry.CellToPosition(doors[i]);
    out.Line(R"(<geom name="{}" type="box" size="{:.9g} {:.9g} {:.9g}" pos="{:.9g} {:.9g} {}")"
             R"( group="{}"/>)",
             DoorElement(static_cast<int>(i), 0), half_cell, half_cell, kWallHeightM / 2.0, at.x_m,
             at.y_m, kOpenDoorM, kCollisionGroup);
  }
  return boxes;
}

/// Walls, floor and goals; a part of <worldbody>. All visible geoms are in a body "scenery" that
/// cannot collide; all colliding geoms (ground, boxes) are invisible. Returns the number of boxes.
int WriteMaze(MjcfWriter& out, const PhysicsWorld& world) {
  const GridGeometry geometry{world.truth.rows(), world.truth.columns(), world.cell_size_m};
  const Grid<char> walls = WallClasses(world);
  const int boxes = world.open ? WriteTerrain(out, world)
                               : WriteCollisionGeoms(out, geometry, walls, world.doors);
  out.Line(R"(<body name="scenery" childclass="scenery">)");
  out.Line(R"(<inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/>)");  // planes have no mass
  if (world.heights.size() == 0) {
    WriteWallFaces(out, geometry, walls, world.texture_seed);
    WriteFloor(out, geometry, FloorClasses(world));
    WriteDoors(out, world, geometry);
  } else {
    out.Line(R"(<geom type="plane" size="{:.9g} {:.9g} 1" material="{}"/>)",
             geometry.columns * geometry.cell_size_m / 2.0,
             geometry.rows * geometry.cell_size_m / 2.0, FloorTextureName(kWaterTexture));
  }
  WriteGoals(out, world, geometry);
  out.Line("</body>");
  return boxes;
}

// The robots.

std::string Rgba(const std::array<double, 3>& color) {
  return fmt::format("{:.4g} {:.4g} {:.4g} 1", color[0], color[1], color[2]);
}

/// A part that is drawn but does not collide. `more`: further attributes.
void WritePart(MjcfWriter& out, int robot, const RobotPart& part, const char* more = "") {
  const bool is_cylinder = part.shape == PartShape::kCylinder;
  const auto& size = part.size_m;
  out.Line(R"(<geom name="{}" class="scenery" type="{}" size="{}" pos="{:.9g} {:.9g} {:.9g}")"
           R"({}{} rgba="{}"/>)",
           RobotElement(robot, part.name), is_cylinder ? "cylinder" : "ellipsoid",
           is_cylinder ? fmt::format("{:.9g} {:.9g}", size[0], size[1])
                       : fmt::format("{:.9g} {:.9g} {:.9g}", size[0], size[1], size[2]),
           part.at_m[0], part.at_m[1], part.at_m[2] - kHeadHeightM,
           part.lies ? R"( zaxis="1 0 0")" : "", more, Rgba(part.color));
}

/// The head is narrower than the ball below it, so only the ball can touch anything.
void WriteHead(MjcfWriter& out, const std::vector<RobotPart>& parts, int robot) {
  out.Line(R"(<inertial pos="0 0 -.08" mass="20" diaginertia=".10987294 .10986016 .14683229"/>)");
  for (const RobotPart& part : parts) {
    if (part.shape == PartShape::kCylinder) WritePart(out, robot, part);
  }
}

/// Of the ball, 1 kg. Any yaw inertia but a sphere's must be at least half of that.
double RollInertia(const PhysicsWorld& world) {
  return 0.4 * world.robot_radius_m * world.robot_radius_m;
}
double YawInertia(const PhysicsWorld& world) {
  return world.robot_radius_m == kBallRadiusM ? RollInertia(world) : RollInertia(world) / 2.0;
}

void WriteCamera(MjcfWriter& out, const PhysicsWorld& world, int robot) {
  out.Line(R"(<body name="{}" pos="{} 0 {:.9g}">)", RobotElement(robot, "camera_body"),
           kCameraForwardM, kCameraHeightM - kHeadHeightM);
  // What a ball of another size turns harder, the camera's body turns easier.
  constexpr double kBallInertia = 0.4 * kBallRadiusM * kBallRadiusM;
  const double inertia = 1.0 - (YawInertia(world) - kBallInertia);
  out.Line(R"(<inertial pos="0 0 0" mass="1" diaginertia="{:.9g} {:.9g} {:.9g}"/>)", inertia,
           inertia, inertia);
  // MJCF gives the field of view in degrees, whatever the compiler's angle. Image right is -y,
  // image up is +z leant forward by the pitch.
  out.Line(R"(<camera name="{}" fovy="{:.9g}" xyaxes="0 -1 0 {:.9g} 0 {:.9g}"/>)",
           RobotElement(robot, "camera"), kCameraVerticalFovRad * 180.0 / std::numbers::pi,
           std::sin(kCameraPitchRad), std::cos(kCameraPitchRad));
  out.Line("</body>");
}

/// The ball that rolls and touches; as large as the robot. Damping and inertia are such that robots
/// of any size speed up and turn alike. A large robot, or a boat, looks like a hull.
void WriteWheel(MjcfWriter& out, const PhysicsWorld& world, const std::vector<RobotPart>& parts,
                int robot) {
  const double radius_m = world.robot_radius_m;
  const double scale = radius_m / kBallRadiusM;
  const bool hull = HasHull(world);
  out.Line(R"(<body name="{}" pos="0 0 {:.9g}">)", RobotElement(robot, "wheel"),
           radius_m - kHeadHeightM);
  out.Line(R"(<joint name="{}" type="hinge" axis="0 1 0" damping="{:.9g}"/>)",
           RobotElement(robot, "roll"), 5.0 * scale * scale);
  out.Line(R"(<geom name="{}" type="sphere" size="{:.9g}" mass="1" material="ball" rgba="{}")"
           R"( group="{}"/>)",
           RobotElement(robot, "shell"), radius_m, Rgba(RobotColor(robot)),
           hull ? kCollisionGroup : kVisibleGroup);
  if (scale != 1.0) {
    out.Line(R"(<inertial pos="0 0 0" mass="1" diaginertia="{:.9g} {:.9g} {:.9g}"/>)",
             YawInertia(world), RollInertia(world), YawInertia(world));
  }
  out.Line("</body>");
  if (hull) WritePart(out, robot, parts.back(), R"( mass="0")");
}

/// One robot's bodies at the origin; a part of <worldbody>.
void WriteRobot(MjcfWriter& out, const PhysicsWorld& world, int robot) {
  const std::vector<RobotPart> parts = RobotParts(world, robot);
  out.Line(R"(<body name="{}" pos="0 0 {}">)", RobotElement(robot, "body"), kHeadHeightM);
  for (const auto& [name, axis] : {std::pair("x", "1 0 0"), {"y", "0 1 0"}, {"z", "0 0 1"}}) {
    out.Line(R"(<joint name="{}" type="slide" axis="{}"/>)", RobotElement(robot, name), axis);
  }
  out.Line(R"(<joint name="{}" type="hinge" axis="0 0 -1" damping="20"/>)",
           RobotElement(robot, "steer"));
  WriteHead(out, parts, robot);
  WriteCamera(out, world, robot);
  WriteWheel(out, world, parts, robot);
  out.Line("</body>");
}

/// A robot's two motors; a part of <actuator>.
void WriteRobotMotors(MjcfWriter& out, const PhysicsWorld& world, int robot) {
  const double roll =
      -50.0 * world.robot_radius_m / kBallRadiusM * world.top_speed_mps / kTopSpeedMps;
  for (const auto& [joint, gear] : {std::pair("roll", roll), std::pair("steer", 30.0)}) {
    const std::string name = RobotElement(robot, joint);
    out.Line(R"(<motor name="{}" joint="{}" ctrlrange="-1 1" ctrllimited="true" gear="{:.9g}"/>)",
             name, name, gear);
  }
}

/// The contact pairs of a robot's ball: ground, boxes, the balls of robots before it; a part of
/// <contact>. With many boxes a list is several times faster than MuJoCo's search.
void WriteContacts(MjcfWriter& out, int robot, int boxes, int doors) {
  const std::string shell = RobotElement(robot, "shell");
  // Two sliding directions, torsion, two rolling directions (unused in four dimensions): the larger
  // of the two geoms' coefficients, MuJoCo's 1 for scenery and MemoryMaze's .5/.02/.02 for robots.
  const auto pair = [&](const std::string& other, double sliding) {
    out.Line(R"(<pair geom1="{}" geom2="{}" condim="4" friction="{} {} .02 .02 .02"/>)", other,
             shell, sliding, sliding);
  };
  pair("ground", 1.0);
  for (int box = 0; box < boxes; ++box) pair(BoxName(box), 1.0);
  for (int door = 0; door < doors; ++door) pair(DoorElement(door, 0), 1.0);
  for (int other = 0; other < robot; ++other) pair(RobotElement(other, "shell"), 0.5);
}

}  // namespace

std::string WriteMjcf(const PhysicsWorld& world) {
  const int robot_count = static_cast<int>(world.robots.size());
  MjcfWriter out;
  out.Line(R"(<mujoco model="conav">)");
  WriteGlobals(out, world);
  WriteAssets(out, world);
  out.Line("<worldbody>");
  const int boxes = WriteMaze(out, world);
  for (int robot = 0; robot < robot_count; ++robot) WriteRobot(out, world, robot);
  out.Line("</worldbody>");
  out.Line("<contact>");
  for (int robot = 0; robot < robot_count; ++robot)
    WriteContacts(out, robot, boxes, static_cast<int>(world.doors.size()));
  out.Line("</contact>");
  out.Line("<actuator>");
  for (int robot = 0; robot < robot_count; ++robot) WriteRobotMotors(out, world, robot);
  out.Line("</actuator>");
  out.Line("</mujoco>");
  return out.Take();
}

}  // namespace conav::sim
