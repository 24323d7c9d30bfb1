#pragma once

#include <memory>
#include <string>

#include "common/runtime/result.h"

// One user: the camera; off-screen rendering is looked for by name.

namespace conav::sim {

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
  struct Handles;
  explicit EglContext(Handles handles);
  Result<void> CheckOpenGl();

  std::unique_ptr<Handles> handles_;
  std::string renderer_name_;
  int max_size_ = 0;
};

}  // namespace conav::sim
