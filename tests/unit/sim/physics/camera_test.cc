#include "sim/physics/camera.h"

#include <malloc.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <map>
#include <opencv2/imgcodecs.hpp>
#include <set>
#include <string>
#include <vector>

#include "common/runtime/random.h"
#include "sim/physics/mjcf.h"
#include "support/resident_memory.h"
#include "unit/sim/physics/mazes.h"

namespace conav::sim {
namespace {

using test::MakeWorld;
using test::Open;

/// What the pixels of a picture show, from the geoms that MuJoCo drew there.
enum class PixelKind { kNone, kFloor, kWall, kGoal, kRobot };

struct PixelLabel {
  PixelKind kind = PixelKind::kNone;
  Cell cell;       // of a floor or wall
  int index = -1;  // of a goal or robot
};

/// By geom, without cells.
std::vector<PixelLabel> LabelsOfGeoms(const RobotWorld& world) {
  const mjModel& model = world.model();
  std::vector<PixelLabel> labels(static_cast<std::size_t>(model.ngeom));
  const int scenery = mj_name2id(&model, mjOBJ_BODY, "scenery");
  for (int geom = 0; geom < model.ngeom; ++geom) {
    if (model.geom_bodyid[geom] != scenery || model.geom_type[geom] != mjGEOM_PLANE) continue;
    // A standing plane is a wall, a lying one the floor: local z is (0, 0, 1) for the identity.
    const bool lying = model.geom_quat[4 * geom] > 0.999;
    labels[static_cast<std::size_t>(geom)].kind = lying ? PixelKind::kFloor : PixelKind::kWall;
  }
  const auto name = [&](const std::string& element, PixelKind kind, int index) {
    const int geom = mj_name2id(&model, mjOBJ_GEOM, element.c_str());
    labels[static_cast<std::size_t>(geom)] = {kind, {}, index};
  };
  for (int goal = 0; goal < static_cast<int>(world.world().goals.size()); ++goal) {
    name(GoalElement(goal), PixelKind::kGoal, goal);
  }
  for (int robot = 0; robot < world.robot_count(); ++robot) {
    for (const char* part : {"head", "face", "neck", "shell"}) {
      name(RobotElement(robot, part), PixelKind::kRobot, robot);
    }
  }
  return labels;
}

/// Where the ray of a pixel meets the plane of a floor or wall, which may span many cells.
Cell CellOfPixel(const RobotWorld& world, int geom, PixelKind kind, const mjtNum* start,
                 const mjtNum* ray) {
  const mjtNum* point = world.data().geom_xpos + 3 * geom;
  const mjtNum* rotation = world.data().geom_xmat + 9 * geom;
  const mjtNum normal[3] = {rotation[2], rotation[5], rotation[8]};
  mjtNum to_plane[3];
  mju_sub3(to_plane, point, start);
  const double reach = mju_dot3(normal, to_plane) / mju_dot3(normal, ray);
  // A wall's face lies on the edge of its cell: step into the wall.
  const double inside = kind == PixelKind::kWall ? world.geometry().cell_size_m / 2.0 : 0.0;
  return world.geometry().PositionToCell({start[0] + reach * ray[0] - inside * normal[0],
                                          start[1] + reach * ray[1] - inside * normal[1]});
}

/// Row 0 is the upper row.
Grid<PixelLabel> LabelPixels(const RobotWorld& world, Camera& camera, int robot) {
  const Grid<int> geoms = camera.RenderGeoms(robot);
  const std::vector<PixelLabel> labels = LabelsOfGeoms(world);
  const int id = mj_name2id(&world.model(), mjOBJ_CAMERA, RobotElement(robot, "camera").c_str());
  const mjtNum* rotation = world.data().cam_xmat + 9 * id;  // image right, image up, backwards
  const double tan_half_height = std::tan(kCameraVerticalFovRad / 2.0);
  const double tan_half_width = tan_half_height * geoms.columns() / geoms.rows();
  Grid<PixelLabel> shown(geoms.rows(), geoms.columns());
  for (std::size_t i = 0; i < shown.size(); ++i) {
    const int geom = geoms.values()[i];
    if (geom < 0) continue;
    PixelLabel& label = shown.values()[i];
    label = labels[static_cast<std::size_t>(geom)];
    if (label.kind != PixelKind::kFloor && label.kind != PixelKind::kWall) continue;
    const Cell pixel = shown.CellAt(i);
    const double right = tan_half_width * (2.0 * (pixel.column + 0.5) / geoms.columns() - 1.0);
    const double up = tan_half_height * (1.0 - 2.0 * (pixel.row + 0.5) / geoms.rows());
    mjtNum ray[3];
    for (int axis = 0; axis < 3; ++axis) {
      const mjtNum* row = rotation + 3 * axis;
      ray[axis] = right * row[0] + up * row[1] - row[2];
    }
    label.cell = CellOfPixel(world, geom, label.kind, world.data().cam_xpos + 3 * id, ray);
  }
  return shown;
}

std::unique_ptr<Camera> OpenCamera(const RobotWorld& world, CameraOptions options = {}) {
  auto opened = Camera::Open(world, options);
  if (!opened) FAIL(opened.error().text);
  return std::move(opened.value());
}

std::size_t ColorCount(const RgbImage& image) {
  std::set<int> colors;
  for (std::size_t i = 0; i < image.rgb.size(); i += 3) {
    colors.insert(image.rgb[i] << 16 | image.rgb[i + 1] << 8 | image.rgb[i + 2]);
  }
  return colors.size();
}

int CountKind(const Grid<PixelLabel>& labels, PixelKind kind) {
  return static_cast<int>(std::ranges::count(labels.values(), kind, &PixelLabel::kind));
}

TEST_CASE("pictures have the size asked for and show something", "[camera]") {
  const auto world = Open(MakeWorld(test::kMaze));
  const auto [width, height] =
      GENERATE(std::pair{320, 192}, std::pair{640, 480}, std::pair{64, 64});
  const auto camera = OpenCamera(*world, {width, height});
  const RgbImage image = camera->Render(0);
  CHECK(image.width == width);
  CHECK(image.height == height);
  CHECK(image.rgb.size() == static_cast<std::size_t>(width * height * 3));
  CHECK(ColorCount(image) > 100);
}

TEST_CASE("pictures differ between headings and repeat at the same pose", "[camera]") {
  const auto world = Open(MakeWorld(test::kMaze));
  const auto camera = OpenCamera(*world);
  std::set<std::string> snapshots;
  for (int round = 0; round < 2; ++round) {
    for (int heading = 0; heading < 8; ++heading) {
      world->Teleport(0, world->geometry().CellToPosition({1, 1}), HeadingFromIndex(heading, 8));
      const RgbImage snapshot = camera->Render(0);
      snapshots.emplace(snapshot.rgb.begin(), snapshot.rgb.end());
    }
  }
  CHECK(snapshots.size() == 8);
  // The sky is up, the floor is down.
  const auto hall = Open(MakeWorld(test::kHall, {3, 1}));
  const auto labels = LabelPixels(*hall, *OpenCamera(*hall), 0);
  CHECK(labels[{0, 160}].kind == PixelKind::kNone);
  CHECK(labels[{191, 160}].kind == PixelKind::kFloor);
}

TEST_CASE("pictures of open terrain show land, water and sky in all eight headings", "[camera]") {
  PhysicsWorld lake;
  lake.open = true;
  lake.cell_size_m = 1.0;
  lake.robot_radius_m = 0.5;
  lake.truth = OccupancyGrid(21, 31, Occupancy::kFree);
  lake.heights = Grid<float>(21, 31, -1.0F);
  for (std::size_t i = 0; i < lake.truth.size(); ++i) {
    if (!lake.truth.OnBorder(lake.truth.CellAt(i))) continue;
    lake.truth.values()[i] = Occupancy::kOccupied;
    lake.heights.values()[i] = 1.0F;
  }
  lake.robots = {{"r1", {10, 15}, 0.0}};
  const auto world = Open(std::move(lake));
  const auto camera = OpenCamera(*world);
  const int land = mj_name2id(&world->model(), mjOBJ_GEOM, "box0");
  REQUIRE(world->model().geom_type[land] == mjGEOM_HFIELD);
  for (int heading = 0; heading < 8; ++heading) {
    world->Teleport(0, {0.0, 0.0}, HeadingFromIndex(heading, 8));
    const Grid<int> geoms = camera->RenderGeoms(0);
    CHECK(geoms[{0, 160}] == -1);
    CHECK(world->model().geom_type[geoms[{190, 160}]] == mjGEOM_PLANE);
    const auto pixels = static_cast<std::size_t>(std::ranges::count(geoms.values(), land));
    CHECK(pixels > geoms.size() / 50);
    CHECK(pixels < geoms.size() / 2);
  }
}

TEST_CASE("taking pictures does not change the motion", "[camera]") {
  const auto drive = [](bool with_camera) {
    const auto world = Open(MakeWorld(test::kMaze));
    const auto camera = OpenCamera(*world);
    world->MoveTo(0, {2, 1});
    for (int i = 0; i < 12; ++i) {
      world->Step();
      if (with_camera) camera->Render(0);
    }
    const RobotPose pose = world->pose(0);
    return std::vector<double>{pose.position.x_m, pose.position.y_m, pose.heading_rad};
  };
  CHECK(drive(true) == drive(false));
}

TEST_CASE("a robot sees another robot, never itself, and a goal in its place until it is hidden",
          "[camera]") {
  PhysicsWorld spec = MakeWorld(test::kMaze);
  spec.robots.push_back({"r2", {1, 2}, 0.0});
  const auto meeting = Open(spec);
  const auto beside = OpenCamera(*meeting);
  const auto robots = LabelPixels(*meeting, *beside, 0);
  CHECK(CountKind(robots, PixelKind::kRobot) > 100);
  for (const PixelLabel& label : robots.values()) {
    if (label.kind == PixelKind::kRobot) CHECK(label.index == 1);
  }
  CHECK(CountKind(LabelPixels(*meeting, *beside, 1), PixelKind::kRobot) == 0);
  spec.robots.pop_back();
  spec.goals = {{{5, 5}, 1}, {{1, 3}, 0}};
  const auto world = Open(spec);
  const auto camera = OpenCamera(*world);
  const auto labels = LabelPixels(*world, *camera, 0);
  CHECK(CountKind(labels, PixelKind::kGoal) > 100);
  for (const PixelLabel& label : labels.values()) {
    if (label.kind == PixelKind::kGoal) CHECK(label.index == 1);
  }
  world->SetGoalVisible(1, false);
  CHECK(CountKind(LabelPixels(*world, *camera, 0), PixelKind::kGoal) == 0);
}

TEST_CASE("a door is seen when it has closed", "[camera]") {
  PhysicsWorld plan = MakeWorld(test::kHall, {3, 1});
  plan.doors = {{3, 3}};
  const auto world = Open(plan);
  const auto camera = Camera::Open(*world, {64, 48}).value();
  const auto plain = Open(MakeWorld(test::kHall, {3, 1}));
  const auto other = Camera::Open(*plain, {64, 48}).value();
  CHECK(camera->Render(0).rgb == other->Render(0).rgb);
  world->CloseDoor(0);
  const int face = mj_name2id(&world->model(), mjOBJ_GEOM, DoorElement(0, 4).c_str());
  CHECK(camera->RenderGeoms(0)[{24, 32}] == face);  // 3 m ahead, its west side
}

TEST_CASE("two cameras of different sizes work side by side", "[camera]") {
  const auto world = Open(MakeWorld(test::kMaze));
  const auto small = OpenCamera(*world, {320, 192});
  const std::vector<std::uint8_t> before = small->Render(0).rgb;
  {
    const auto large = OpenCamera(*world, {640, 480});
    CHECK(large->Render(0).width == 640);
    CHECK(small->Render(0).rgb == before);
  }
  CHECK(small->Render(0).rgb == before);
}

// Two hours of soak: the simulator grew by 1.4 and 3.8 MB at once, with the largest picture so far.
TEST_CASE("the largest picture's memory is there before the first", "[camera]") {
  if (!conav::test::kMeasuresMemory) return;
  const auto world = Open(MakeWorld(test::kMaze));
  mallopt(M_TRIM_THRESHOLD, std::numeric_limits<int>::max());  // as a service that draws
  const std::size_t free_before = mallinfo2().fordblks;
  const auto camera = OpenCamera(*world, {320, 192});
  if (!camera->renderer_name().starts_with("llvmpipe")) return;
  CHECK(mallinfo2().fordblks >= free_before + (std::size_t{80} << 20));
}

TEST_CASE("impossible sizes are refused by name, the field of view follows the picture's shape",
          "[camera]") {
  const auto world = Open(MakeWorld(test::kMaze));
  const auto camera_result = Camera::Open(*world, {0, 192});
  REQUIRE_FALSE(camera_result);
  CHECK(camera_result.error().code == ErrorCode::kInvalidArgument);
  CHECK_THAT(camera_result.error().text, Catch::Matchers::Contains("0x192"));
  CHECK_FALSE(Camera::Open(*world, {320, 5000}));
  CHECK(HorizontalFov(100, 100) == Approx(kCameraVerticalFovRad));
  CHECK(HorizontalFov(320, 192) == Approx(2.0 * std::atan(5.0 / 3.0 * std::tan(0.6981317))));
}

/// Left half red, right half blue.
RgbImage TwoColors(int width, int height) {
  RgbImage image{width, height, {}};
  for (int i = 0; i < width * height; ++i) {
    const bool left = i % width < width / 2;
    for (const int value : {left ? 200 : 20, 30, left ? 20 : 200}) {
      image.rgb.push_back(static_cast<std::uint8_t>(value));
    }
  }
  return image;
}

TEST_CASE("a JPEG decodes to its size and colours, a lower quality gives fewer bytes",
          "[physics]") {
  RgbImage image = TwoColors(320, 192);
  const auto jpeg = EncodeJpeg(image, 90);
  REQUIRE(jpeg);
  const cv::Mat decoded = cv::imdecode(*jpeg, cv::IMREAD_COLOR);
  REQUIRE(decoded.size() == cv::Size(320, 192));
  const auto pixel = decoded.at<cv::Vec3b>(0, 0);  // blue, green, red
  CHECK(static_cast<int>(pixel[2]) == Approx(200).margin(8));
  CHECK(static_cast<int>(pixel[0]) == Approx(20).margin(8));
  CHECK(EncodeJpeg(image, 90).value() == *jpeg);
  for (std::size_t i = 0; i < image.rgb.size(); ++i) {
    image.rgb[i] = static_cast<std::uint8_t>(image.rgb[i] ^ (i * 2654435761U >> 28));
  }
  CHECK(EncodeJpeg(image, 20)->size() < EncodeJpeg(image, 95)->size());
}

TEST_CASE("pictures that are not whole are refused, and qualities out of range", "[physics]") {
  CHECK(EncodeJpeg({}, 90).error().code == ErrorCode::kInvalidArgument);
  CHECK(EncodeJpeg({2, 2, {1, 2, 3}}, 90).error().code == ErrorCode::kInvalidArgument);
  CHECK(EncodeJpeg(TwoColors(8, 8), 0).error().code == ErrorCode::kInvalidArgument);
  CHECK(EncodeJpeg(TwoColors(8, 8), 101).error().code == ErrorCode::kInvalidArgument);
}

/// CastView, the two-dimensional model of what a picture shows, against MuJoCo's segmentation of
/// the picture itself (docs/paper.md).

constexpr int kPoses = 30;
constexpr int kCoveredPixels = 20;

struct Shown {
  std::map<Cell, int> floor;  // pixels by cell
  std::map<Cell, int> walls;
};

Shown CountPixels(const Grid<PixelLabel>& labels) {
  Shown shown;
  for (const PixelLabel& label : labels.values()) {
    if (label.kind == PixelKind::kFloor) ++shown.floor[label.cell];
    if (label.kind == PixelKind::kWall) ++shown.walls[label.cell];
  }
  return shown;
}

struct Tally {
  int covered = 0;  // cells of at least kCoveredPixels
  int missed = 0;   // of these, not in CastView
  int walls = 0;    // walls in CastView
  int unshown = 0;  // of these, without a single pixel
};

void Compare(const std::map<Cell, int>& shown, const std::vector<Cell>& cast, Tally& tally) {
  for (const auto& [cell, pixels] : shown) {
    if (pixels < kCoveredPixels) continue;
    ++tally.covered;
    if (!std::ranges::binary_search(cast, cell)) ++tally.missed;
  }
}

TEST_CASE("CastView agrees with MuJoCo's segmentation", "[camera]") {
  const auto [width, height] =
      GENERATE(std::pair{320, 192}, std::pair{640, 480}, std::pair{256, 256});
  const test::Rows& rows =
      GENERATE(std::cref(test::kMaze), std::cref(test::kWideMaze), std::cref(test::kHall));
  const double cell_size_m = GENERATE(1.0, 2.0);
  const PhysicsWorld spec = MakeWorld(rows, {1, 1}, cell_size_m);
  const auto opened = Open(spec);
  RobotWorld& world = *opened;
  const auto camera = OpenCamera(world, {width, height});
  Tally tally;
  Random random(11);
  const std::vector<Cell> cells = test::FreeCells(spec.truth);
  for (int pose = 0; pose < kPoses; ++pose) {
    const Cell cell = cells[static_cast<std::size_t>(
        random.Uniform(0, static_cast<std::int64_t>(cells.size()) - 1))];
    const double heading_rad = HeadingFromIndex(static_cast<int>(random.Uniform(0, 23)), 24);
    world.Teleport(0, world.geometry().CellToPosition(cell), heading_rad);
    const Shown shown = CountPixels(LabelPixels(world, *camera, 0));
    const VisibleCells cast =
        CastView(spec.truth, ViewAt(cell, heading_rad, cell_size_m, width, height));
    Compare(shown.floor, cast.free, tally);
    Compare(shown.walls, cast.walls, tally);
    for (const Cell wall : cast.walls) {
      ++tally.walls;
      if (!shown.walls.contains(wall)) ++tally.unshown;
    }
  }
  CAPTURE(width, height, cell_size_m, tally.covered, tally.walls);
  CHECK(tally.covered > 100);
  CHECK(tally.missed == 0);
  CHECK(tally.unshown <= tally.walls / 100);  // slivers under a pixel wide
}

}  // namespace
}  // namespace conav::sim
