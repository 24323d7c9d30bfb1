#include "sim/physics/world_model.h"

#include <fmt/core.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "sim/physics/mjcf.h"
#include "sim/physics/textures.h"

namespace conav::sim {
namespace {

Result<void> CheckGrid(const PhysicsWorld& world) {
  const OccupancyGrid& truth = world.truth;
  const double smallest = world.open ? kMinOpenCellSizeM : kMinCellSizeM;
  if (!std::isfinite(world.cell_size_m) || world.cell_size_m < smallest) {
    return Fail(ErrorCode::kOutOfRange,
                fmt::format("cell size {} m is too small for the robot; at least {} m",
                            world.cell_size_m, smallest));
  }
  if (truth.size() == 0 || truth.rows() > kMaxCellsPerSide || truth.columns() > kMaxCellsPerSide) {
    return Fail(ErrorCode::kOutOfRange,
                fmt::format("map of {}x{} cells; 1 to {} per side", truth.rows(), truth.columns(),
                            kMaxCellsPerSide));
  }
  const auto unknown = std::ranges::find(truth.values(), Occupancy::kUnknown);
  if (unknown != truth.values().end()) {
    const auto index = static_cast<std::size_t>(unknown - truth.values().begin());
    return Fail(ErrorCode::kInvalidArgument,
                fmt::format("cell {} of the true map is unknown", truth.CellAt(index)));
  }
  const Grid<float>& heights = world.heights;
  if (heights.size() != 0 &&
      (!world.open || heights.rows() != truth.rows() || heights.columns() != truth.columns())) {
    return Fail(
        ErrorCode::kInvalidArgument,
        fmt::format("heights of {}x{} cells for a{} map of {}x{}", heights.rows(),
                    heights.columns(), world.open ? "n open" : "", truth.rows(), truth.columns()));
  }
  for (const Grid<char>* classes : {&world.wall_classes, &world.floor_classes}) {
    if (classes->size() != 0 &&
        (classes->rows() != truth.rows() || classes->columns() != truth.columns())) {
      return Fail(ErrorCode::kInvalidArgument,
                  fmt::format("texture classes of {}x{} cells for a map of {}x{}", classes->rows(),
                              classes->columns(), truth.rows(), truth.columns()));
    }
  }
  return {};
}

/// The error names `what` and `cell` when the cell is outside or a wall.
Result<void> CheckFree(const PhysicsWorld& world, const std::string& what, Cell cell) {
  if (!world.truth.Contains(cell)) {
    return Fail(ErrorCode::kOutOfRange,
                fmt::format("{} at {} lies outside of the {}x{} map", what, cell,
                            world.truth.rows(), world.truth.columns()));
  }
  if (world.truth[cell] == Occupancy::kOccupied) {
    return Fail(ErrorCode::kInvalidArgument,
                fmt::format("{} at {} is inside of a wall", what, cell));
  }
  return {};
}

Result<void> CheckDoors(const PhysicsWorld& world) {
  for (const Cell door : world.doors) {
    if (world.open) return Fail(ErrorCode::kInvalidArgument, "open terrain has no doors");
    if (auto free = CheckFree(world, "door", door); !free) return free;
    const bool is_start = std::ranges::any_of(
        world.robots, [&](const RobotSpec& robot) { return robot.start == door; });
    if (!is_start) continue;
    return Fail(ErrorCode::kInvalidArgument, fmt::format("door at {} is a robot's start", door));
  }
  return {};
}

Result<void> CheckBody(const PhysicsWorld& world) {
  const double radius_m = world.robot_radius_m;
  const bool fits = world.open ? radius_m >= 0.05 && radius_m <= 2.0 : radius_m == kBallRadiusM;
  if (!fits) {
    return Fail(ErrorCode::kOutOfRange,
                fmt::format("robot radius {} m; {}", radius_m,
                            world.open ? "0.05 to 2 m" : "0.2 m unless the terrain is open"));
  }
  if (!(world.top_speed_mps >= 0.1 && world.top_speed_mps <= kTopSpeedMps)) {
    return Fail(ErrorCode::kOutOfRange,
                fmt::format("top speed {} m/s; 0.1 to {} m/s", world.top_speed_mps, kTopSpeedMps));
  }
  return {};
}

Result<void> CheckRobots(const PhysicsWorld& world) {
  if (auto checked = CheckBody(world); !checked) return checked;
  if (world.robots.empty() || world.robots.size() > kMaxRobots) {
    return Fail(ErrorCode::kOutOfRange,
                fmt::format("{} robots; 1 to {}", world.robots.size(), kMaxRobots));
  }
  std::set<Cell> taken;
  std::set<std::string> names;
  for (const RobotSpec& robot : world.robots) {
    if (auto checked = CheckFree(world, "robot " + robot.name, robot.start); !checked) {
      return checked;
    }
    if (!std::isfinite(robot.heading_rad)) {
      return Fail(ErrorCode::kInvalidArgument, "heading of robot " + robot.name + " is not finite");
    }
    if (!names.insert(robot.name).second) {
      return Fail(ErrorCode::kInvalidArgument, "two robots are named " + robot.name);
    }
    if (!taken.insert(robot.start).second) {
      return Fail(ErrorCode::kInvalidArgument,
                  fmt::format("two robots start at cell {}", robot.start));
    }
  }
  return {};
}

void PaintTexture(mjModel& model, const std::string& name, Rgb color, int variant,
                  void (*draw)(Rgb, int, std::span<std::uint8_t>)) {
  const int id = mj_name2id(&model, mjOBJ_TEXTURE, name.c_str());
  DEMAND(id >= 0, name);
  draw(color, variant,
       {model.tex_rgb + model.tex_adr[id],
        static_cast<std::size_t>(kTextureSize) * kTextureSize * 3});
}

void PaintTextures(mjModel& model, const PhysicsWorld& world) {
  for (int i = 0; i < kWallTextureCount; ++i) {
    PaintTexture(model, WallTextureName(i), kWallColors[i], i, DrawWallTexture);
  }
  for (int i = 0; i < FloorTextures(world); ++i) {
    PaintTexture(model, FloorTextureName(i), kFloorColors[i], i, DrawFloorTexture);
  }
}

/// MuJoCo's rows begin in the south; its heights are shares of kTerrainTopM - kTerrainBedM.
void FillHeightField(mjModel& model, const PhysicsWorld& world) {
  for (int row = 0; row < world.truth.rows(); ++row) {
    for (int column = 0; column < world.truth.columns(); ++column) {
      const double height = TerrainHeight(world, {world.truth.rows() - 1 - row, column});
      const auto node = static_cast<std::ptrdiff_t>(row) * world.truth.columns() + column;
      model.hfield_data[model.hfield_adr[0] + node] =
          static_cast<float>((height - kTerrainBedM) / (kTerrainTopM - kTerrainBedM));
    }
  }
}

}  // namespace

double GoalRadius(const PhysicsWorld& world) {
  return world.open ? kGoalRadiusM : std::min(kGoalRadiusM, 0.3 * world.cell_size_m);
}

void ModelDeleter::operator()(mjModel_* model) const { mj_deleteModel(model); }

Result<void> CheckWorld(const PhysicsWorld& world) {
  if (auto checked = CheckGrid(world); !checked) return checked;
  if (auto checked = CheckRobots(world); !checked) return checked;
  for (std::size_t i = 0; i < world.goals.size(); ++i) {
    if (auto checked = CheckFree(world, fmt::format("goal {}", i), world.goals[i].cell); !checked) {
      return checked;
    }
  }
  return CheckDoors(world);
}

Result<ModelPtr> BuildModel(const PhysicsWorld& world) {
  if (auto checked = CheckWorld(world); !checked) return tl::unexpected(checked.error());
  const std::string text = WriteMjcf(world);
  const auto files = std::make_unique<mjVFS>();  // too large for the stack
  mj_defaultVFS(files.get());
  DEMAND(mj_makeEmptyFileVFS(files.get(), "world.xml", static_cast<int>(text.size())) == 0,
         text.size());
  std::ranges::copy(text, static_cast<char*>(files->filedata[0]));
  char error[1000] = "";
  ModelPtr model(mj_loadXML("world.xml", files.get(), error, sizeof(error)));
  mj_deleteVFS(files.get());
  if (!model) {
    return Fail(ErrorCode::kInvalidArgument, fmt::format("MuJoCo rejects the world: {}", error));
  }
  PaintTextures(*model, world);
  if (world.open) FillHeightField(*model, world);
  return model;
}

}  // namespace conav::sim
