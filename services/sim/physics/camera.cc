#include "sim/physics/camera.h"

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <thread>
#include <utility>

#include "common/runtime/demand.h"
#include "sim/physics/egl_context.h"
#include "sim/physics/mjcf.h"
#include "sim/physics/pixel_labels.h"

namespace conav::sim {
namespace {

constexpr int kMinSize = 16;
constexpr int kMaxSize = 4096;

/// MuJoCo's lower row comes first; ours is the upper.
void FlipRows(RgbImage& image) {
  const auto stride = static_cast<std::ptrdiff_t>(image.width) * 3;
  auto upper = image.rgb.begin();
  auto lower = image.rgb.end() - stride;
  for (; upper < lower; upper += stride, lower -= stride) {
    std::swap_ranges(upper, upper + stride, lower);
  }
}

mjvCamera RobotCamera(const RobotWorld& world, int robot) {
  DEMAND(robot >= 0 && robot < world.robot_count(), robot);
  mjvCamera camera;
  mjv_defaultCamera(&camera);
  camera.type = mjCAMERA_FIXED;
  camera.fixedcamid =
      mj_name2id(&world.model(), mjOBJ_CAMERA, RobotElement(robot, "camera").c_str());
  return camera;
}

}  // namespace

/// The OpenGL side: MuJoCo's render context and scene, sized for one camera.
struct Camera::Context {
  Context(const RobotWorld& world, const CameraOptions& options,
          std::unique_ptr<EglContext> egl_context);
  ~Context();
  /// Draws what `camera` sees into an image; fills `scene`.
  RgbImage Draw(const RobotWorld& world, mjvCamera camera, bool segmentation);

  std::thread::id thread = std::this_thread::get_id();
  std::unique_ptr<EglContext> egl;
  int width;
  int height;
  PixelLabeler labeler;
  mjrContext render;
  mjvScene scene;
  mjvOption option;
};

Camera::Context::Context(const RobotWorld& world, const CameraOptions& options,
                         std::unique_ptr<EglContext> egl_context)
    : egl(std::move(egl_context)), width(options.width), height(options.height), labeler(world) {
  egl->MakeCurrent();
  // The size of the off-screen buffer is read from the model; ours stays as it is.
  const ModelPtr model(mj_copyModel(nullptr, &world.model()));
  model->vis.global.offwidth = width;
  model->vis.global.offheight = height;
  mjr_defaultContext(&render);
  mjr_makeContext(model.get(), &render, mjFONTSCALE_50);
  mjr_setBuffer(mjFB_OFFSCREEN, &render);
  mjv_defaultScene(&scene);
  mjv_makeScene(&world.model(), &scene, world.model().ngeom + 100);
  mjv_defaultOption(&option);
}

Camera::Context::~Context() {
  DEMAND(thread == std::this_thread::get_id());
  egl->MakeCurrent();
  mjv_freeScene(&scene);
  mjr_freeContext(&render);
}

RgbImage Camera::Context::Draw(const RobotWorld& world, mjvCamera camera, bool segmentation) {
  DEMAND(thread == std::this_thread::get_id());
  egl->MakeCurrent();
  mjr_setBuffer(mjFB_OFFSCREEN, &render);
  // After a step MuJoCo's positions are those from before its last integration.
  mj_kinematics(&world.model(), &world.data());
  mj_comPos(&world.model(), &world.data());
  mj_camlight(&world.model(), &world.data());
  mjv_updateScene(&world.model(), &world.data(), &option, nullptr, &camera, mjCAT_ALL, &scene);
  scene.flags[mjRND_SHADOW] = 0;
  scene.flags[mjRND_REFLECTION] = 0;
  scene.flags[mjRND_SEGMENT] = segmentation;
  scene.flags[mjRND_IDCOLOR] = segmentation;
  const mjrRect viewport{0, 0, width, height};
  mjr_render(viewport, &scene, &render);
  RgbImage image{width, height, {}};
  image.rgb.resize(static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * 3);
  mjr_readPixels(image.rgb.data(), nullptr, viewport, &render);
  FlipRows(image);
  return image;
}

Result<std::unique_ptr<Camera>> Camera::Open(const RobotWorld& world, CameraOptions options) {
  const auto fits = [](int size) { return size >= kMinSize && size <= kMaxSize; };
  if (!fits(options.width) || !fits(options.height)) {
    return Fail(ErrorCode::kInvalidArgument,
                fmt::format("camera of {}x{} pixels; {} to {} per side", options.width,
                            options.height, kMinSize, kMaxSize));
  }
  auto egl_result = EglContext::Open();
  if (!egl_result) return tl::unexpected(egl_result.error());
  const int limit = egl_result.value()->max_size();
  if (std::max(options.width, options.height) > limit) {
    return Fail(ErrorCode::kUnavailable,
                fmt::format("camera of {}x{} pixels; {} renders at most {} per side", options.width,
                            options.height, egl_result.value()->renderer_name(), limit));
  }
  auto context = std::make_unique<Context>(world, options, std::move(egl_result.value()));
  return std::unique_ptr<Camera>(new Camera(world, options, std::move(context)));
}

Camera::Camera(const RobotWorld& world, CameraOptions options, std::unique_ptr<Context> context)
    : world_(world), options_(options), context_(std::move(context)) {}

Camera::~Camera() = default;

const std::string& Camera::renderer_name() const { return context_->egl->renderer_name(); }

RgbImage Camera::Render(int robot) {
  return context_->Draw(world_, RobotCamera(world_, robot), false);
}

RgbImage Camera::RenderTop() {
  mjvCamera camera;
  mjv_defaultCamera(&camera);
  camera.azimuth = 90.0;
  camera.elevation = -90.0;
  const double rows_m = world_.geometry().rows * world_.geometry().cell_size_m;
  const double columns_m = world_.geometry().columns * world_.geometry().cell_size_m;
  const double side = std::max(rows_m, columns_m * options_.height / options_.width);
  const double half_fov_rad = world_.model().vis.global.fovy * mjPI / 360.0;
  camera.distance = kWallHeightM + 0.5 * side / std::tan(half_fov_rad);
  context_->option.geomgroup[kTopGroup] = 1;
  RgbImage image = context_->Draw(world_, camera, false);
  context_->option.geomgroup[kTopGroup] = 0;
  return image;
}

Grid<PixelLabel> Camera::RenderSegmentation(int robot) {
  const mjvCamera camera = RobotCamera(world_, robot);
  const RgbImage ids = context_->Draw(world_, camera, true);
  std::vector<int> geoms(ids.rgb.size() / 3, -1);
  for (std::size_t i = 0; i < geoms.size(); ++i) {
    const std::uint8_t* pixel = ids.rgb.data() + 3 * i;
    const int scene_geom = pixel[0] + 256 * pixel[1] + 65536 * pixel[2] - 1;
    if (scene_geom < 0 || scene_geom >= context_->scene.ngeom) continue;
    const mjvGeom& geom = context_->scene.geoms[scene_geom];
    if (geom.objtype == mjOBJ_GEOM) geoms[i] = geom.objid;
  }
  Projection projection;
  const mjData& data = world_.data();
  std::copy_n(data.cam_xpos + 3 * camera.fixedcamid, 3, projection.position);
  std::copy_n(data.cam_xmat + 9 * camera.fixedcamid, 9, projection.rotation);
  projection.tan_half_height = std::tan(kCameraVerticalFovRad / 2.0);
  projection.width = options_.width;
  projection.height = options_.height;
  return context_->labeler.Label(projection, geoms);
}

}  // namespace conav::sim
