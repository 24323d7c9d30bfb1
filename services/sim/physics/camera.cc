#include "sim/physics/camera.h"

#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <GL/gl.h>
#include <fmt/core.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <memory>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

#include "sim/physics/mjcf.h"

namespace conav::sim {
namespace {

template <class Function>
Function Load(const char* name) {
  return reinterpret_cast<Function>(eglGetProcAddress(name));
}

bool Lists(const char* extensions, std::string_view name) {
  const std::string padded = fmt::format(" {} ", extensions == nullptr ? "" : extensions);
  return padded.find(fmt::format(" {} ", name)) != std::string::npos;
}

struct Candidate {
  std::string name;
  EGLDisplay display = EGL_NO_DISPLAY;
};

/// Displays of the EGL devices that are (or are not) software renderers.
void AddDevices(bool software, std::vector<Candidate>& candidates) {
  const auto query = Load<PFNEGLQUERYDEVICESEXTPROC>("eglQueryDevicesEXT");
  const auto describe = Load<PFNEGLQUERYDEVICESTRINGEXTPROC>("eglQueryDeviceStringEXT");
  const auto open = Load<PFNEGLGETPLATFORMDISPLAYEXTPROC>("eglGetPlatformDisplayEXT");
  if (query == nullptr || describe == nullptr || open == nullptr) return;
  EGLDeviceEXT devices[16];
  EGLint count = 0;
  if (query(16, devices, &count) != EGL_TRUE) return;
  for (int i = 0; i < count; ++i) {
    const bool is_software =
        Lists(describe(devices[i], EGL_EXTENSIONS), "EGL_MESA_device_software");
    if (is_software != software) continue;
    candidates.push_back({fmt::format("{} device {}", software ? "software" : "hardware", i),
                          open(EGL_PLATFORM_DEVICE_EXT, devices[i], nullptr)});
  }
}

std::vector<Candidate> FindDisplays() {
  std::vector<Candidate> candidates;
  const char* extensions = eglQueryString(EGL_NO_DISPLAY, EGL_EXTENSIONS);
  const bool devices = Lists(extensions, "EGL_EXT_platform_device");
  if (devices) AddDevices(false, candidates);
  if (Lists(extensions, "EGL_MESA_platform_surfaceless")) {
    const auto open = Load<PFNEGLGETPLATFORMDISPLAYEXTPROC>("eglGetPlatformDisplayEXT");
    candidates.push_back(
        {"surfaceless Mesa", open(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr)});
  }
  if (devices) AddDevices(true, candidates);
  candidates.push_back({"default display", eglGetDisplay(EGL_DEFAULT_DISPLAY)});
  return candidates;
}

/// An off-screen OpenGL context without a window system. Tries, in this order: hardware EGL
/// devices, Mesa without a surface (software rendering when there is no GPU), the software device,
/// the default display. Threads: MakeCurrent binds it to the calling thread; use it there only.
class EglContext {
 public:
  /// Fails with kUnavailable: the attempts, and the Debian packages that provide EGL.
  static Result<std::unique_ptr<EglContext>> Open();
  ~EglContext();
  EglContext(const EglContext&) = delete;
  EglContext& operator=(const EglContext&) = delete;

  void MakeCurrent();
  /// GL_RENDERER, for example "llvmpipe (LLVM 15.0.6, 256 bits)".
  const std::string& renderer_name() const { return renderer_name_; }
  /// Largest side of an off-screen buffer, pixels.
  int max_size() const { return max_size_; }

 private:
  struct Handles {
    EGLDisplay display = EGL_NO_DISPLAY;
    EGLSurface surface = EGL_NO_SURFACE;
    EGLContext context = EGL_NO_CONTEXT;
  };
  explicit EglContext(const Handles& handles) : handles_(handles) {}
  /// An OpenGL context with a 1x1 pbuffer on `display`, or the reason for failure.
  static Result<Handles> CreateContext(EGLDisplay display);
  Result<void> CheckOpenGl();

  Handles handles_;
  std::string renderer_name_;
  int max_size_ = 0;
};

Result<EglContext::Handles> EglContext::CreateContext(EGLDisplay display) {
  Handles handles;
  handles.display = display;
  const auto fail = [](const char* call) {
    return Fail(ErrorCode::kUnavailable,
                fmt::format("{} failed (EGL error 0x{:x})", call, eglGetError()));
  };
  if (display == EGL_NO_DISPLAY || eglInitialize(display, nullptr, nullptr) != EGL_TRUE) {
    return fail("eglInitialize");
  }
  if (eglBindAPI(EGL_OPENGL_API) != EGL_TRUE) return fail("eglBindAPI");
  const EGLint wanted[] = {EGL_SURFACE_TYPE,
                           EGL_PBUFFER_BIT,
                           EGL_RENDERABLE_TYPE,
                           EGL_OPENGL_BIT,
                           EGL_RED_SIZE,
                           8,
                           EGL_GREEN_SIZE,
                           8,
                           EGL_BLUE_SIZE,
                           8,
                           EGL_DEPTH_SIZE,
                           24,
                           EGL_NONE};
  EGLConfig config = nullptr;
  EGLint count = 0;
  if (eglChooseConfig(display, wanted, &config, 1, &count) != EGL_TRUE || count < 1) {
    return fail("eglChooseConfig");
  }
  const EGLint size[] = {EGL_WIDTH, 1, EGL_HEIGHT, 1, EGL_NONE};
  handles.surface = eglCreatePbufferSurface(display, config, size);
  if (handles.surface == EGL_NO_SURFACE) return fail("eglCreatePbufferSurface");
  handles.context = eglCreateContext(display, config, EGL_NO_CONTEXT, nullptr);
  if (handles.context == EGL_NO_CONTEXT ||
      eglMakeCurrent(display, handles.surface, handles.surface, handles.context) != EGL_TRUE) {
    if (handles.context != EGL_NO_CONTEXT) eglDestroyContext(display, handles.context);
    eglDestroySurface(display, handles.surface);
    return fail("eglCreateContext");
  }
  return handles;
}

Result<std::unique_ptr<EglContext>> EglContext::Open() {
  std::string tried;
  for (const Candidate& candidate : FindDisplays()) {
    std::string reason;
    if (auto handles_result = CreateContext(candidate.display)) {
      std::unique_ptr<EglContext> context(new EglContext(handles_result.value()));
      const auto checked = context->CheckOpenGl();
      if (checked) return context;
      reason = checked.error().text;
    } else {
      reason = handles_result.error().text;
    }
    tried += fmt::format("{}{}: {}", tried.empty() ? "" : "; ", candidate.name, reason);
  }
  return Fail(ErrorCode::kUnavailable,
              fmt::format("cannot render off screen over EGL ({}); install the Debian packages "
                          "libegl1 and libgl1-mesa-dri, or run without a camera",
                          tried));
}

/// The display stays initialised: other contexts of this process share it.
EglContext::~EglContext() {
  eglMakeCurrent(handles_.display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
  eglDestroyContext(handles_.display, handles_.context);
  eglDestroySurface(handles_.display, handles_.surface);
}

void EglContext::MakeCurrent() {
  if (eglGetCurrentContext() == handles_.context) return;
  eglBindAPI(EGL_OPENGL_API);
  const EGLBoolean current =
      eglMakeCurrent(handles_.display, handles_.surface, handles_.surface, handles_.context);
  DEMAND(current == EGL_TRUE, eglGetError());
}

/// MuJoCo ends the process if it cannot use the OpenGL, so its requirements are checked here.
Result<void> EglContext::CheckOpenGl() {
  const auto get_string = Load<const GLubyte* (*)(GLenum)>("glGetString");
  const auto get_integer = Load<void (*)(GLenum, GLint*)>("glGetIntegerv");
  if (get_string == nullptr || get_integer == nullptr) {
    return Fail(ErrorCode::kUnavailable, "no OpenGL functions");
  }
  const auto text = [&](GLenum name) { return reinterpret_cast<const char*>(get_string(name)); };
  if (text(GL_RENDERER) == nullptr) return Fail(ErrorCode::kUnavailable, "no OpenGL renderer");
  renderer_name_ = text(GL_RENDERER);
  const char* extensions = text(GL_EXTENSIONS);
  for (const char* needed : {"GL_ARB_framebuffer_object", "GL_ARB_vertex_buffer_object"}) {
    if (!Lists(extensions, needed)) {
      return Fail(ErrorCode::kUnavailable, fmt::format("{} lacks {}", renderer_name_, needed));
    }
  }
  constexpr GLenum kMaxRenderbufferSize = 0x84E8;
  get_integer(kMaxRenderbufferSize, &max_size_);
  return {};
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
  if (!IsWhole(image)) {
    return Fail(
        ErrorCode::kInvalidArgument,
        fmt::format("picture of {}x{} with {} bytes", image.width, image.height, image.rgb.size()));
  }
  const cv::Mat pixels(image.height, image.width, CV_8UC3,
                       const_cast<std::uint8_t*>(image.rgb.data()));
  std::vector<std::uint8_t> bytes;
  try {
    if (cv::imencode(".jpg", Swapped(pixels), bytes, {cv::IMWRITE_JPEG_QUALITY, quality})) {
      return bytes;
    }
  } catch (const cv::Exception& exception) {
    return Fail(ErrorCode::kUnavailable, fmt::format("JPEG encoder: {}", exception.what()));
  }
  return Fail(ErrorCode::kUnavailable, "JPEG encoder failed");
}

/// Mesa's software renderer takes a scene's memory for each picture and frees it after that: blocks
/// of 64 KiB, at most 36 MiB (its LP_SCENE_MAX_SIZE) for each of two scenes. A process that keeps
/// what it freed would grow with each picture that shows more than all before; so all is taken
/// once, with 16 MiB for what comes to lie between them: of 16 robots the pictures for late joiners
/// (4 MiB), buffers of the bus.
void TakeMemoryOfScenes() {
  constexpr std::size_t kBlockBytes = 64 * 1024;
  constexpr std::size_t kBlocks = (2 * 36 + 16) * 16;
  std::vector<std::unique_ptr<char[]>> blocks(kBlocks);
  for (auto& block : blocks) block = std::make_unique<char[]>(kBlockBytes);
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
  mjrContext render;
  mjvScene scene;
  mjvOption option;
};

Camera::Context::Context(const RobotWorld& world, const CameraOptions& options,
                         std::unique_ptr<EglContext> egl_context)
    : egl(std::move(egl_context)), width(options.width), height(options.height) {
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
  if (egl->renderer_name().starts_with("llvmpipe")) TakeMemoryOfScenes();
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

Grid<int> Camera::RenderGeoms(int robot) {
  const RgbImage ids = context_->Draw(world_, RobotCamera(world_, robot), true);
  Grid<int> geoms(ids.height, ids.width, -1);
  for (std::size_t i = 0; i < geoms.size(); ++i) {
    const std::uint8_t* pixel = ids.rgb.data() + 3 * i;
    const int scene_geom = pixel[0] + 256 * pixel[1] + 65536 * pixel[2] - 1;
    if (scene_geom < 0 || scene_geom >= context_->scene.ngeom) continue;
    const mjvGeom& geom = context_->scene.geoms[scene_geom];
    if (geom.objtype == mjOBJ_GEOM) geoms.values()[i] = geom.objid;
  }
  return geoms;
}

}  // namespace conav::sim
