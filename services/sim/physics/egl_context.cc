#include "sim/physics/egl_context.h"

#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <GL/gl.h>
#include <fmt/format.h>

#include <string_view>
#include <vector>

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

std::string EglFailure(const char* call) {
  return fmt::format("{} failed (EGL error 0x{:x})", call, eglGetError());
}

/// An OpenGL context with a 1x1 pbuffer on `display`, or the reason for failure.
template <class Handles>
Result<Handles> CreateContext(EGLDisplay display) {
  Handles handles;
  handles.display = display;
  const auto fail = [](const char* call) {
    return Fail(ErrorCode::kUnavailable, EglFailure(call));
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

}  // namespace

struct EglContext::Handles {
  EGLDisplay display = EGL_NO_DISPLAY;
  EGLSurface surface = EGL_NO_SURFACE;
  EGLContext context = EGL_NO_CONTEXT;
};

Result<std::unique_ptr<EglContext>> EglContext::Open() {
  std::string tried;
  for (const Candidate& candidate : FindDisplays()) {
    std::string reason;
    if (auto handles_result = CreateContext<Handles>(candidate.display)) {
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

EglContext::EglContext(Handles handles) : handles_(std::make_unique<Handles>(handles)) {}

/// The display stays initialised: other contexts of this process share it.
EglContext::~EglContext() {
  eglMakeCurrent(handles_->display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
  eglDestroyContext(handles_->display, handles_->context);
  eglDestroySurface(handles_->display, handles_->surface);
}

void EglContext::MakeCurrent() {
  if (eglGetCurrentContext() == handles_->context) return;
  eglBindAPI(EGL_OPENGL_API);
  const EGLBoolean current =
      eglMakeCurrent(handles_->display, handles_->surface, handles_->surface, handles_->context);
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

}  // namespace conav::sim
