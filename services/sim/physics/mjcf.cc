#include "sim/physics/mjcf.h"

#include <algorithm>

#include "sim/physics/mjcf_writer.h"
#include "sim/physics/textures.h"

namespace conav::sim {
namespace {

void WriteGlobals(MjcfWriter& out, const PhysicsWorld& world) {
  const double extent = std::max(world.truth.rows(), world.truth.columns()) * world.cell_size_m;
  const int contacts = 40 + 24 * static_cast<int>(world.robots.size());
  out.Line(R"(<compiler angle="radian" autolimits="true"/>)");
  out.Line(R"(<option timestep="{}" cone="elliptic" noslip_iterations="5" noslip_tolerance="0")"
           R"( collision="predefined"/>)",
           kPhysicsStepS);
  out.Line(R"(<size njmax="{}" nconmax="{}"/>)", contacts * 6, contacts);
  out.Line(R"(<statistic center="0 0 0" extent="{:.9g}"/>)", extent);
  out.Line(R"(<default><default class="scenery"><geom contype="0" conaffinity="0"/></default>)");
  out.Line(R"(</default>)");
  out.Line(R"(<visual>)");
  out.Line(R"(<headlight ambient=".45 .45 .45" diffuse=".6 .6 .6" specular="0 0 0"/>)");
  // Near plane 2 cm; far enough for the camera from above at 100 m and for the diagonal.
  out.Line(R"(<map znear="{:.9g}" zfar="{:.9g}"/>)", 0.02 / extent,
           (150.0 + 2.0 * extent) / extent);
  out.Line(
      R"(<quality shadowsize="0" offsamples="4" numslices="24" numstacks="12" numquads="1"/>)");
  out.Line(R"(<global offwidth="64" offheight="64"/>)");
  out.Line(R"(</visual>)");
}

void WriteTexture(MjcfWriter& out, const std::string& name) {
  out.Line(
      R"(<texture name="{}" type="2d" builtin="flat" rgb1=".5 .5 .5" width="{}" height="{}"/>)",
      name, kTextureSize, kTextureSize);
}

void WriteAssets(MjcfWriter& out, const PhysicsWorld& world) {
  // MuJoCo counts repeats per half unit of length here.
  const double per_cell = 2.0 / world.cell_size_m;
  out.Line("<asset>");
  out.Line(R"(<texture type="skybox" builtin="gradient" rgb1=".4 .6 .8" rgb2="0 0 0")"
           R"( width="100" height="100"/>)");
  out.Line(R"(<texture name="ball" type="cube" builtin="checker" rgb1="1 1 1" rgb2=".35 .35 .35")"
           R"( width="32" height="32"/>)");
  out.Line(R"(<material name="ball" texture="ball"/>)");
  for (int i = 0; i < kWallTextureCount; ++i) {
    const std::string name = WallTextureName(i);
    WriteTexture(out, name);
    out.Line(R"(<material name="{}" texture="{}" texuniform="true" texrepeat="{:.9g} {:.9g}"/>)",
             name, name, per_cell, 2.0 / kWallHeightM);
  }
  for (int i = 0; i < kFloorTextureCount; ++i) {
    const std::string name = FloorTextureName(i);
    WriteTexture(out, name);
    out.Line(R"(<material name="{}" texture="{}" texuniform="true" texrepeat="{:.9g} {:.9g}"/>)",
             name, name, per_cell, per_cell);
  }
  out.Line("</asset>");
}

}  // namespace

std::string Rgba(Rgb color) {
  return fmt::format("{:.4g} {:.4g} {:.4g} 1", color.red / 255.0, color.green / 255.0,
                     color.blue / 255.0);
}

std::string RobotElement(int robot, const char* part) {
  return fmt::format("robot{}/{}", robot, part);
}
std::string GoalElement(int goal) { return fmt::format("goal{}", goal); }
std::string WallTextureName(int texture) { return fmt::format("wall{}", texture); }
std::string FloorTextureName(int texture) { return fmt::format("floor{}", texture); }

std::string WriteMjcf(const PhysicsWorld& world) {
  const int robot_count = static_cast<int>(world.robots.size());
  MjcfWriter out;
  out.Line(R"(<mujoco model="conav">)");
  WriteGlobals(out, world);
  WriteAssets(out, world);
  out.Line("<worldbody>");
  const int boxes = WriteMaze(out, world);
  for (int robot = 0; robot < robot_count; ++robot) WriteRobot(out, robot);
  out.Line("</worldbody>");
  out.Line("<contact>");
  for (int robot = 0; robot < robot_count; ++robot) WriteContacts(out, robot, boxes);
  out.Line("</contact>");
  out.Line("<actuator>");
  for (int robot = 0; robot < robot_count; ++robot) WriteRobotMotors(out, robot);
  out.Line("</actuator>");
  out.Line("</mujoco>");
  return out.Take();
}

}  // namespace conav::sim
