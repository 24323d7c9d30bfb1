#pragma once

#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "sim/physics/camera.h"
#include "sim/physics/mjcf.h"

/// What the pixels of a picture show, from the geoms that MuJoCo drew there.
namespace conav::sim::test {

enum class PixelKind { kNone, kFloor, kWall, kGoal, kRobot };

struct PixelLabel {
  PixelKind kind = PixelKind::kNone;
  Cell cell;       // of a floor or wall
  int index = -1;  // of a goal or robot
};

/// By geom, without cells.
inline std::vector<PixelLabel> LabelsOfGeoms(const RobotWorld& world) {
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
inline Cell CellOfPixel(const RobotWorld& world, int geom, PixelKind kind, const mjtNum* start,
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
inline Grid<PixelLabel> LabelPixels(const RobotWorld& world, Camera& camera, int robot) {
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

}  // namespace conav::sim::test
