#include "bench/console/camera_pictures.h"

#include <numbers>

#include "common/runtime/result.h"
#include "sim/config.h"
#include "sim/physics/camera.h"
#include "sim/world/world_spec.h"

namespace conav::bench {
namespace {

template <class T>
T Checked(Result<T> result) {
  if (!result) throw StartupError("pictures of the camera: " + result.error().text);
  return std::move(result.value());
}

std::unique_ptr<sim::RobotWorld> MakeMaze() {
  const sim::WorldSpec spec = Checked(sim::MakeWorldSpec({}));
  sim::PhysicsWorld world;
  world.truth = spec.truth;
  world.wall_classes = spec.wall_classes;
  world.floor_classes = spec.floor_classes;
  world.robots = {{"r1", spec.starts.front(), 0.0}};
  return Checked(sim::RobotWorld::Create(std::move(world)));
}

}  // namespace

std::vector<std::vector<std::uint8_t>> CameraPictures(int count) {
  const sim::CameraConfig config;
  const auto maze = MakeMaze();
  const auto camera = Checked(sim::Camera::Open(*maze, {config.width, config.height}));
  const Position start = maze->pose(0).position;
  std::vector<std::vector<std::uint8_t>> pictures;
  for (int i = 0; i < count; ++i) {
    maze->Teleport(0, start, 2.0 * std::numbers::pi * i / count);
    pictures.push_back(Checked(sim::EncodeJpeg(camera->Render(0), config.jpeg_quality)));
  }
  return pictures;
}

}  // namespace conav::bench
