#include "sim/physics/robot_body.h"

#include <fmt/core.h>

#include <iterator>
#include <numbers>

#include "common/grid/visibility.h"

namespace conav::sim {
namespace {

constexpr double kQuarterTurn = std::numbers::pi / 2.0;

constexpr Rgb kRobotColors[] = {{235, 180, 60},  {60, 190, 220},  {230, 90, 140},
                                {130, 210, 100}, {170, 120, 230}, {240, 240, 240}};
constexpr std::array<double, 3> kHeadColor{0.76, 0.76, 0.76};

std::string Geometry(const RobotPart& part) {
  const auto& size = part.size_m;
  switch (part.shape) {
    case PartShape::kSphere:
      return fmt::format(R"(<sphere radius="{:.9g}"/>)", size[0]);
    case PartShape::kCylinder:
      return fmt::format(R"(<cylinder radius="{:.9g}" length="{:.9g}"/>)", size[0], 2.0 * size[1]);
    case PartShape::kEllipsoid:
      break;
  }
  return fmt::format(R"(<box size="{:.9g} {:.9g} {:.9g}"/>)", 2.0 * size[0], 2.0 * size[1],
                     2.0 * size[2]);
}

std::string Visual(const RobotPart& part) {
  return fmt::format(
      R"(    <visual name="{0}">
      <origin xyz="{1:.9g} {2:.9g} {3:.9g}" rpy="0 {4:.9g} 0"/>
      <geometry>{5}</geometry>
      <material name="{0}"><color rgba="{6:.4g} {7:.4g} {8:.4g} 1"/></material>
    </visual>
)",
      part.name, part.at_m[0], part.at_m[1], part.at_m[2], part.lies ? kQuarterTurn : 0.0,
      Geometry(part), part.color[0], part.color[1], part.color[2]);
}

std::string Joint(const FixedFrame& frame) {
  const FramePose& pose = frame.pose;
  return fmt::format(
      R"(  <link name="{0}"/>
  <joint name="{0}_joint" type="fixed">
    <parent link="{1}"/>
    <child link="{0}"/>
    <origin xyz="{2:.9g} {3:.9g} {4:.9g}" rpy="{5:.9g} {6:.9g} {7:.9g}"/>
  </joint>
)",
      frame.child, frame.parent, pose.x_m, pose.y_m, pose.z_m, pose.roll_rad, pose.pitch_rad,
      pose.yaw_rad);
}

}  // namespace

std::array<double, 3> RobotColor(int robot) {
  const Rgb color = kRobotColors[static_cast<std::size_t>(robot) % std::size(kRobotColors)];
  return {color.red / 255.0, color.green / 255.0, color.blue / 255.0};
}

bool HasHull(const PhysicsWorld& world) {
  return world.heights.size() != 0 || world.robot_radius_m > kHeadHeightM - kBallRadiusM;
}

std::vector<RobotPart> RobotParts(const PhysicsWorld& world, int robot) {
  using enum PartShape;
  const double radius_m = world.robot_radius_m;
  const auto color = RobotColor(robot);
  std::vector<RobotPart> parts{
      {"head", kCylinder, {0.1, 0.06}, {0.0, 0.0, kHeadHeightM - 0.07}, false, kHeadColor},
      {"face", kCylinder, {0.05, 0.035}, {0.1, 0.0, kHeadHeightM - 0.07}, true, color},
      {"neck", kCylinder, {0.07, 0.02}, {0.0, 0.0, kHeadHeightM - 0.13}, false, color}};
  if (HasHull(world)) {
    parts.push_back({"hull",
                     kEllipsoid,
                     {radius_m, 0.6 * radius_m, 0.3 * radius_m},
                     {0.0, 0.0, 0.15},
                     false,
                     color});
  } else {
    parts.push_back({"shell", kSphere, {radius_m}, {0.0, 0.0, radius_m}, false, color});
  }
  return parts;
}

const std::array<FixedFrame, 2>& CameraFrames() {
  static const std::array<FixedFrame, 2> frames{
      FixedFrame{kBaseFrame,
                 kCameraFrame,
                 {kCameraForwardM, 0.0, kCameraHeightM, 0.0, kCameraPitchRad, 0.0}},
      FixedFrame{kCameraFrame, kOpticalFrame, {0.0, 0.0, 0.0, -kQuarterTurn, 0.0, -kQuarterTurn}}};
  return frames;
}

std::string WriteUrdf(const PhysicsWorld& world, int robot) {
  std::string text =
      fmt::format("<?xml version=\"1.0\"?>\n<robot name=\"{}\">\n  <link name=\"{}\">\n",
                  world.robots[static_cast<std::size_t>(robot)].name, kBaseFrame);
  for (const RobotPart& part : RobotParts(world, robot)) text += Visual(part);
  text += "  </link>\n";
  for (const FixedFrame& frame : CameraFrames()) text += Joint(frame);
  return text + "</robot>\n";
}

}  // namespace conav::sim
