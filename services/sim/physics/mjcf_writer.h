#pragma once

#include <fmt/format.h>

#include <iterator>
#include <string>
#include <utility>

#include "sim/physics/world_model.h"

namespace conav::sim {

/// Collects MJCF text line by line. Numbers that matter are written with nine digits ({:.9g}).
class MjcfWriter {
 public:
  template <class... Values>
  void Line(fmt::format_string<Values...> format, Values&&... values) {
    fmt::format_to(std::back_inserter(text_), format, std::forward<Values>(values)...);
    text_ += '\n';
  }
  std::string Take() { return std::move(text_); }

 private:
  std::string text_;
};

/// "r g b 1" in [0, 1].
std::string Rgba(Rgb color);

/// Walls, floor and goals; a part of <worldbody>. Everything drawn is in a body "scenery" that
/// cannot collide; what collides (ground, boxes) is not drawn. Returns the number of boxes.
int WriteMaze(MjcfWriter& out, const PhysicsWorld& world);
/// One robot's bodies at the origin; a part of <worldbody>.
void WriteRobot(MjcfWriter& out, int robot);
/// Its two motors; a part of <actuator>.
void WriteRobotMotors(MjcfWriter& out, int robot);

/// What the robot's ball can touch: ground, boxes, the balls of robots before it; a part of
/// <contact>. A list is several times faster than MuJoCo's search when there are many boxes.
void WriteContacts(MjcfWriter& out, int robot, int boxes);

}  // namespace conav::sim
