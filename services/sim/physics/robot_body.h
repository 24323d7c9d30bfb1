#pragma once

#include <array>
#include <string>
#include <vector>

#include "common/grid/frames.h"
#include "sim/physics/world_model.h"

namespace conav::sim {

/// A robot's shape and frames: the numbers of both its MuJoCo model (mjcf.cc) and its URDF.

/// Height of the body that carries head and camera, above base_link.
inline constexpr double kHeadHeightM = 0.6;

enum class PartShape { kSphere, kCylinder, kEllipsoid };

/// A visible part of a robot.
struct RobotPart {
  const char* name;  // of its element in the model: RobotElement(robot, name)
  PartShape shape = PartShape::kSphere;
  std::array<double, 3> size_m{};  // radius; radius and half length; half axes
  std::array<double, 3> at_m{};    // its middle in base_link
  bool lies = false;               // a cylinder along x, else along z
  std::array<double, 3> color{};   // red, green, blue in [0, 1]
};

/// The shell or trim colour that marks one robot among others.
std::array<double, 3> RobotColor(int robot);

/// Head, face and neck, and the ball that rolls, or for a large robot or a boat its hull.
std::vector<RobotPart> RobotParts(const PhysicsWorld& world, int robot);

/// Whether the ball is inside of a hull.
bool HasHull(const PhysicsWorld& world);

/// A frame that is fixed in its parent.
struct FixedFrame {
  std::string_view parent;
  std::string_view child;
  FramePose pose;
};

/// base_link -> camera_link -> camera_optical_frame, of every robot.
const std::array<FixedFrame, 2>& CameraFrames();

/// The robot as URDF, frame ids plain: RViz's "TF Prefix" adds the name where robots share a tree.
/// URDF knows no ellipsoid: a hull is a box of the same extent.
std::string WriteUrdf(const PhysicsWorld& world, int robot);

}  // namespace conav::sim
