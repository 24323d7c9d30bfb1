#include "sim/physics/camera.h"

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <span>
#include <thread>
#include <utility>

#include "common/grid/grid.h"
#include "sim/physics/egl_context.h"
#include "sim/physics/mjcf.h"

namespace conav::sim {
namespace {

/// Where a camera is and how it projects, taken from MuJoCo after its kinematics.
struct Projection {
  double position[3] = {};
  double rotation[9] = {};  // row-major; columns are image right, image up, backwards
  double tan_half_height = 0.0;
  int width = 0;
  int height = 0;
};

/// Turns MuJoCo's geom ids into labels. A wall or floor geom spans many cells; the cell of a pixel
/// is where its ray meets the geom's plane.
class PixelLabeler {
 public:
  explicit PixelLabeler(const RobotWorld& world);

  /// `geoms`: one model geom id per pixel, -1 for none; row 0 is the upper row.
  Grid<PixelLabel> Label(const Projection& projection, std::span<const int> geoms) const;

 private:
  struct GeomLabel {
    PixelKind kind = PixelKind::kNone;
    int index = -1;
  };
  Cell CellOf(int geom, PixelKind kind, const double* origin, const double* direction) const;

  const RobotWorld& world_;
  std::vector<GeomLabel> labels_;  // by geom id
};

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
  using Eigen::Map, Eigen::Vector3d;
  const Map<const Vector3d> point(world_.data().geom_xpos + 3 * geom);
  const Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>> rotation(world_.data().geom_xmat +
                                                                         9 * geom);
  const Vector3d normal = rotation.col(2);
  const Map<const Vector3d> start(origin);
  const Map<const Vector3d> ray(direction);
  const double reach = normal.dot(point - start) / normal.dot(ray);
  // A wall's face lies on the edge of its cell: step into the wall.
  const double inside = kind == PixelKind::kWall ? world_.geometry().cell_size_m / 2.0 : 0.0;
  const Vector3d hit = start + reach * ray - inside * normal;
  return world_.geometry().PositionToCell({hit.x(), hit.y()});
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

bool IsWhole(const RgbImage& image) {
  return image.width > 0 && image.height > 0 &&
         image.rgb.size() ==
             static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height) * 3;
}

/// Swaps red and blue: OpenCV's codecs expect blue first.
cv::Mat Swapped(const cv::Mat& pixels) {
  cv::Mat swapped(pixels.rows, pixels.cols, CV_8UC3);
  const int pairs[] = {0, 2, 1, 1, 2, 0};
  cv::mixChannels(&pixels, 1, &swapped, 1, pairs, 3);
  return swapped;
}

Result<std::vector<std::uint8_t>> Encode(const RgbImage& image, const char* extension,
                                         const std::vector<int>& parameters) {
  if (!IsWhole(image)) {
    return Fail(
        ErrorCode::kInvalidArgument,
        fmt::format("picture of {}x{} with {} bytes", image.width, image.height, image.rgb.size()));
  }
  const cv::Mat pixels(image.height, image.width, CV_8UC3,
                       const_cast<std::uint8_t*>(image.rgb.data()));
  std::vector<std::uint8_t> bytes;
  try {
    if (cv::imencode(extension, Swapped(pixels), bytes, parameters)) return bytes;
  } catch (const cv::Exception& exception) {
    return Fail(ErrorCode::kUnavailable,
                fmt::format("{} encoder: {}", extension, exception.what()));
  }
  return Fail(ErrorCode::kUnavailable, fmt::format("{} encoder failed", extension));
}

constexpr int kMinSize = 16;
constexpr int kMaxSize = 4096;

/// MuJoCo's lower row comes first; in RgbImage it is the upper row.
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

Result<std::vector<std::uint8_t>> EncodeJpeg(const RgbImage& image, int quality) {
  if (quality < 1 || quality > 100) {
    return Fail(ErrorCode::kInvalidArgument, fmt::format("JPEG quality {}; 1 to 100", quality));
  }
  return Encode(image, ".jpg", {cv::IMWRITE_JPEG_QUALITY, quality});
}

Result<std::vector<std::uint8_t>> EncodePng(const RgbImage& image) {
  return Encode(image, ".png", {});
}

Result<RgbImage> DecodeJpeg(const std::vector<std::uint8_t>& jpeg) {
  if (jpeg.empty()) return Fail(ErrorCode::kMalformed, "empty picture");
  cv::Mat pixels;
  try {
    pixels = cv::imdecode(jpeg, cv::IMREAD_COLOR);
  } catch (const cv::Exception& exception) {
    return Fail(ErrorCode::kMalformed, fmt::format("picture: {}", exception.what()));
  }
  if (pixels.empty()) return Fail(ErrorCode::kMalformed, "not a picture");
  const cv::Mat swapped = Swapped(pixels);
  return RgbImage{swapped.cols, swapped.rows,
                  std::vector<std::uint8_t>(swapped.datastart, swapped.dataend)};
}

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
  // MuJoCo takes the size of the off-screen buffer from the model; a copy leaves ours unchanged.
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
  // After a step MuJoCo's positions are those before its last integration.
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
