#include <catch2/catch.hpp>
#include <cstdlib>

#include "sim/physics/camera.h"
#include "unit/sim/physics/mazes.h"

namespace conav::sim {
namespace {

// A program of its own: EGL looks for its drivers once per process.

TEST_CASE("without an EGL driver the error says what was tried and what to install", "[camera]") {
  setenv("__EGL_VENDOR_LIBRARY_DIRS", "/nonexistent", 1);
  const auto world = test::Open(test::MakeWorld(test::kMaze));
  const auto camera_result = Camera::Open(*world, {});
  REQUIRE_FALSE(camera_result);
  CHECK(camera_result.error().code == ErrorCode::kUnavailable);
  CHECK_THAT(camera_result.error().text, Catch::Matchers::Contains("libgl1-mesa-dri"));
  CHECK_THAT(camera_result.error().text, Catch::Matchers::Contains("default display"));
}

}  // namespace
}  // namespace conav::sim
