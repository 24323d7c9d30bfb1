#include "sim/physics/robot_body.h"

#include <mujoco/mujoco.h>

#include <catch2/catch.hpp>
#include <cmath>
#include <map>
#include <sstream>

#include "sim/physics/mjcf.h"
#include "support/xml_check.h"
#include "unit/sim/physics/mazes.h"

namespace conav::sim {
namespace {

using Vector = std::array<double, 3>;
using Matrix = std::array<double, 9>;  // row by row

Vector Numbers(const char* text) {
  std::istringstream words(text);
  Vector numbers{};
  for (double& number : numbers) words >> number;
  return numbers;
}

/// About fixed x, then y, then z, as URDF's "rpy".
Matrix Rotation(const Vector& rpy) {
  const double cr = std::cos(rpy[0]), sr = std::sin(rpy[0]);
  const double cp = std::cos(rpy[1]), sp = std::sin(rpy[1]);
  const double cy = std::cos(rpy[2]), sy = std::sin(rpy[2]);
  return {cy * cp,
          cy * sp * sr - sy * cr,
          cy * sp * cr + sy * sr,
          sy * cp,
          sy * sp * sr + cy * cr,
          sy * sp * cr - cy * sr,
          -sp,
          cp * sr,
          cp * cr};
}

/// A URDF read back.
struct Urdf {
  explicit Urdf(const std::string& text) {
    REQUIRE(conav::test::XmlError(text).empty());
    document.Parse(text.c_str());
    robot = document.FirstChildElement("robot");
    REQUIRE(robot != nullptr);
  }
  tinyxml2::XMLDocument document;
  const tinyxml2::XMLElement* robot = nullptr;
};

/// The size that MuJoCo has of the shape of a URDF's geometry.
Vector SizeOf(const tinyxml2::XMLElement& geometry) {
  const auto& shape = *geometry.FirstChildElement();
  if (shape.Name() == std::string("sphere")) return {shape.DoubleAttribute("radius")};
  if (shape.Name() == std::string("cylinder")) {
    return {shape.DoubleAttribute("radius"), shape.DoubleAttribute("length") / 2.0};
  }
  const Vector box = Numbers(shape.Attribute("size"));
  return {box[0] / 2.0, box[1] / 2.0, box[2] / 2.0};
}

PhysicsWorld OfRadius(double radius_m) {
  PhysicsWorld world = test::MakeWorld(test::kHall, {2, 2});
  world.robot_radius_m = radius_m;
  world.open = radius_m != kBallRadiusM;
  return world;
}

// Report row 30: ".rviz, URDF, launch file ...: `find` finds none".
TEST_CASE("the URDF has every part of the MuJoCo model, where and as large as it is there",
          "[physics][row30]") {
  const double radius_m = GENERATE(0.2, 0.3, 1.0);  // a ball, a larger one, a hull
  const PhysicsWorld spec = OfRadius(radius_m);
  const auto world = test::Open(spec);
  const mjModel& model = world->model();
  const RobotPose pose = world->pose(0);
  const Urdf urdf(WriteUrdf(spec, 0));
  CHECK(urdf.robot->Attribute("name") == std::string("r1"));
  const auto* link = urdf.robot->FirstChildElement("link");
  REQUIRE(link != nullptr);
  CHECK(link->Attribute("name") == std::string("base_link"));
  int parts = 0;
  for (const auto* visual = link->FirstChildElement("visual"); visual != nullptr;
       visual = visual->NextSiblingElement("visual"), ++parts) {
    const std::string name = visual->Attribute("name");
    CAPTURE(radius_m, name);
    const int geom = mj_name2id(&model, mjOBJ_GEOM, RobotElement(0, name.c_str()).c_str());
    REQUIRE(geom >= 0);
    CHECK(model.geom_group[geom] == kVisibleGroup);
    const auto& origin = *visual->FirstChildElement("origin");
    const Vector at = Numbers(origin.Attribute("xyz"));
    const Vector size = SizeOf(*visual->FirstChildElement("geometry"));
    const Matrix turned = Rotation(Numbers(origin.Attribute("rpy")));
    const mjtNum* there = world->data().geom_xpos + 3 * geom;
    CHECK(at[0] == Approx(there[0] - pose.position.x_m).margin(1e-8));
    CHECK(at[1] == Approx(there[1] - pose.position.y_m).margin(1e-8));
    CHECK(at[2] == Approx(there[2]).margin(1e-8));
    for (int i = 0; i < 3; ++i) {
      const auto axis = static_cast<std::size_t>(i);
      const bool means_size = model.geom_type[geom] != mjGEOM_SPHERE || i == 0;
      if (means_size) CHECK(size[axis] == Approx(model.geom_size[3 * geom + i]).margin(1e-8));
      // The axis of a cylinder.
      const mjtNum along = world->data().geom_xmat[9 * geom + 3 * i + 2];
      CHECK(std::abs(turned[3 * axis + 2]) == Approx(std::abs(along)).margin(1e-8));
    }
  }
  CHECK(parts == 4);
}

TEST_CASE("the URDF's camera frames are the model's camera", "[physics][row25]") {
  const PhysicsWorld spec = OfRadius(0.2);
  const auto world = test::Open(spec);
  const Urdf urdf(WriteUrdf(spec, 0));
  Vector at{};
  Matrix turned = Rotation({});
  std::vector<std::string> chain{"base_link"};
  for (const auto* joint = urdf.robot->FirstChildElement("joint"); joint != nullptr;
       joint = joint->NextSiblingElement("joint")) {
    CHECK(joint->Attribute("type") == std::string("fixed"));
    CHECK(joint->FirstChildElement("parent")->Attribute("link") == chain.back());
    chain.emplace_back(joint->FirstChildElement("child")->Attribute("link"));
    const auto& origin = *joint->FirstChildElement("origin");
    const Vector step = Numbers(origin.Attribute("xyz"));
    const Matrix turn = Rotation(Numbers(origin.Attribute("rpy")));
    Matrix next{};
    for (std::size_t r = 0; r < 3; ++r) {
      for (std::size_t k = 0; k < 3; ++k) {
        at[r] += turned[3 * r + k] * step[k];
        for (std::size_t c = 0; c < 3; ++c) next[3 * r + c] += turned[3 * r + k] * turn[3 * k + c];
      }
    }
    turned = next;
  }
  CHECK(chain == std::vector<std::string>{"base_link", "camera_link", "camera_optical_frame"});
  const int camera = mj_name2id(&world->model(), mjOBJ_CAMERA, RobotElement(0, "camera").c_str());
  REQUIRE(camera >= 0);
  const mjtNum* position = world->data().cam_xpos + 3 * camera;
  const mjtNum* axes = world->data().cam_xmat + 9 * camera;
  const Position base = world->pose(0).position;
  CHECK(at[0] == Approx(position[0] - base.x_m).margin(1e-8));
  CHECK(at[1] == Approx(position[1] - base.y_m).margin(1e-8));
  CHECK(at[2] == Approx(position[2]).margin(1e-8));
  // MuJoCo's camera looks along -z with y up; the optical frame along z with y down.
  for (std::size_t r = 0; r < 3; ++r) {
    CHECK(turned[3 * r] == Approx(axes[3 * r]).margin(1e-8));
    CHECK(turned[3 * r + 1] == Approx(-axes[3 * r + 1]).margin(1e-8));
    CHECK(turned[3 * r + 2] == Approx(-axes[3 * r + 2]).margin(1e-8));
  }
}

}  // namespace
}  // namespace conav::sim
