#include "sim/physics/pixel_labels.h"

#include <mujoco/mujoco.h>

#include <cmath>

#include "common/runtime/demand.h"
#include "sim/physics/mjcf.h"

namespace conav::sim {

PixelLabeler::PixelLabeler(const RobotWorld& world)
    : world_(world), labels_(static_cast<std::size_t>(world.model().ngeom)) {
  const mjModel& model = world.model();
  const int scenery = mj_name2id(&model, mjOBJ_BODY, "scenery");
  for (int geom = 0; geom < model.ngeom; ++geom) {
    if (model.geom_bodyid[geom] != scenery || model.geom_type[geom] != mjGEOM_PLANE) continue;
    // A standing plane is a wall, a lying one the floor: local z is (0, 0, 1) for the identity.
    const bool lying = model.geom_quat[4 * geom] > 0.999;
    labels_[static_cast<std::size_t>(geom)].kind = lying ? PixelKind::kFloor : PixelKind::kWall;
  }
  for (int goal = 0; goal < static_cast<int>(world.world().goals.size()); ++goal) {
    const int geom = mj_name2id(&model, mjOBJ_GEOM, GoalElement(goal).c_str());
    labels_[static_cast<std::size_t>(geom)] = {PixelKind::kGoal, goal};
  }
  for (int robot = 0; robot < world.robot_count(); ++robot) {
    for (const char* part : {"head", "face", "neck", "shell"}) {
      const int geom = mj_name2id(&model, mjOBJ_GEOM, RobotElement(robot, part).c_str());
      labels_[static_cast<std::size_t>(geom)] = {PixelKind::kRobot, robot};
    }
  }
}

Cell PixelLabeler::CellOf(int geom, PixelKind kind, const double* origin,
                          const double* direction) const {
  const double* point = world_.data().geom_xpos + 3 * geom;
  const double* rotation = world_.data().geom_xmat + 9 * geom;
  const double normal[3] = {rotation[2], rotation[5], rotation[8]};
  double ahead = 0.0;
  double slope = 0.0;
  for (int i = 0; i < 3; ++i) {
    ahead += normal[i] * (point[i] - origin[i]);
    slope += normal[i] * direction[i];
  }
  const double reach = ahead / slope;
  // A wall's face lies on the edge of its cell: step into the wall.
  const double inside = kind == PixelKind::kWall ? world_.geometry().cell_size_m / 2.0 : 0.0;
  return world_.geometry().PositionToCell({origin[0] + reach * direction[0] - inside * normal[0],
                                           origin[1] + reach * direction[1] - inside * normal[1]});
}

Grid<PixelLabel> PixelLabeler::Label(const Projection& projection,
                                     std::span<const int> geoms) const {
  Grid<PixelLabel> labels(projection.height, projection.width);
  DEMAND(geoms.size() == labels.size(), geoms.size(), labels.size());
  const double tan_half_width = projection.tan_half_height * projection.width / projection.height;
  for (std::size_t i = 0; i < labels.size(); ++i) {
    if (geoms[i] < 0) continue;
    const GeomLabel geom = labels_[static_cast<std::size_t>(geoms[i])];
    PixelLabel& label = labels.values()[i];
    label = {geom.kind, {}, geom.index};
    if (geom.kind != PixelKind::kFloor && geom.kind != PixelKind::kWall) continue;
    const Cell pixel = labels.CellAt(i);
    const double right = tan_half_width * (2.0 * (pixel.column + 0.5) / projection.width - 1.0);
    const double up =
        projection.tan_half_height * (1.0 - 2.0 * (pixel.row + 0.5) / projection.height);
    double direction[3];
    for (int axis = 0; axis < 3; ++axis) {
      const double* row = projection.rotation + 3 * axis;
      direction[axis] = right * row[0] + up * row[1] - row[2];
    }
    label.cell = CellOf(geoms[i], geom.kind, projection.position, direction);
  }
  return labels;
}

}  // namespace conav::sim
