#include <cmath>
#include <iterator>
#include <numbers>

#include "sim/physics/camera.h"
#include "sim/physics/mjcf.h"
#include "sim/physics/mjcf_writer.h"

namespace conav::sim {
namespace {

constexpr double kHeadHeightM = 0.6;

/// Shell and trim colours that tell robots apart.
constexpr Rgb kRobotColors[] = {{235, 180, 60},  {60, 190, 220},  {230, 90, 140},
                                {130, 210, 100}, {170, 120, 230}, {240, 240, 240}};

/// The head is narrower than the ball below it, so only the ball can touch anything: the head's
/// geoms are drawn but do not collide.
void WriteHead(MjcfWriter& out, int robot, const std::string& trim) {
  out.Line(R"(<inertial pos="0 0 -.08" mass="20" diaginertia=".10987294 .10986016 .14683229"/>)");
  out.Line(
      R"(<geom name="{}" class="scenery" type="cylinder" size=".1 .06" pos="0 0 -.07" rgba=".76 .76 .76 1"/>)",
      RobotElement(robot, "head"));
  out.Line(
      R"(<geom name="{}" class="scenery" type="cylinder" size=".05 .035" pos=".1 0 -.07" zaxis="1 0 0")"
      R"( rgba="{}"/>)",
      RobotElement(robot, "face"), trim);
  out.Line(
      R"(<geom name="{}" class="scenery" type="cylinder" size=".07 .02" pos="0 0 -.13" rgba="{}"/>)",
      RobotElement(robot, "neck"), trim);
}

void WriteCamera(MjcfWriter& out, int robot) {
  out.Line(R"(<body name="{}" pos="{} 0 {:.9g}">)", RobotElement(robot, "camera_body"),
           kCameraForwardM, kCameraHeightM - kHeadHeightM);
  out.Line(R"(<inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/>)");
  // The field of view is in degrees whatever the compiler's angle. Image right is -y, image up is
  // +z leant forward by the pitch.
  out.Line(R"(<camera name="{}" fovy="{:.9g}" xyaxes="0 -1 0 {:.9g} 0 {:.9g}"/>)",
           RobotElement(robot, "camera"), kCameraVerticalFovRad * 180.0 / std::numbers::pi,
           std::sin(kCameraPitchRad), std::cos(kCameraPitchRad));
  out.Line("</body>");
}

void WriteWheel(MjcfWriter& out, int robot, const std::string& color) {
  out.Line(R"(<body name="{}" pos="0 0 -.4">)", RobotElement(robot, "wheel"));
  out.Line(R"(<joint name="{}" type="hinge" axis="0 1 0" damping="5"/>)",
           RobotElement(robot, "roll"));
  out.Line(R"(<geom name="{}" type="sphere" size=".2" mass="1" material="ball" rgba="{}"/>)",
           RobotElement(robot, "shell"), color);
  out.Line("</body>");
}

}  // namespace

void WriteRobot(MjcfWriter& out, int robot) {
  const std::string color =
      Rgba(kRobotColors[static_cast<std::size_t>(robot) % std::size(kRobotColors)]);
  out.Line(R"(<body name="{}" pos="0 0 {}">)", RobotElement(robot, "body"), kHeadHeightM);
  out.Line(R"(<joint name="{}" type="slide" axis="1 0 0"/>)", RobotElement(robot, "x"));
  out.Line(R"(<joint name="{}" type="slide" axis="0 1 0"/>)", RobotElement(robot, "y"));
  out.Line(R"(<joint name="{}" type="slide" axis="0 0 1"/>)", RobotElement(robot, "z"));
  out.Line(R"(<joint name="{}" type="hinge" axis="0 0 -1" damping="20"/>)",
           RobotElement(robot, "steer"));
  WriteHead(out, robot, color);
  WriteCamera(out, robot);
  WriteWheel(out, robot, color);
  out.Line("</body>");
}

void WriteRobotMotors(MjcfWriter& out, int robot) {
  out.Line(R"(<motor name="{}" joint="{}" ctrlrange="-1 1" ctrllimited="true" gear="-50"/>)",
           RobotElement(robot, "roll"), RobotElement(robot, "roll"));
  out.Line(R"(<motor name="{}" joint="{}" ctrlrange="-1 1" ctrllimited="true" gear="30"/>)",
           RobotElement(robot, "steer"), RobotElement(robot, "steer"));
}

}  // namespace conav::sim
