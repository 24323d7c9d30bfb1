#pragma once

#include <string>

#include "sim/physics/world_model.h"

namespace conav::sim {

/// Geom groups: who draws what.
inline constexpr int kVisibleGroup = 0;
inline constexpr int kCollisionGroup = 3;  // drawn by nobody
inline constexpr int kTopGroup = 4;        // wall tops, for the picture from above only
inline constexpr int kHiddenGroup = 5;     // goals that were reached

/// Names inside of the model. Robots and goals are named by index, so that any robot name is legal.
std::string RobotElement(int robot, const char* part);  // "robot3/steer"
std::string GoalElement(int goal);                      // "goal2"
std::string WallTextureName(int texture);
std::string FloorTextureName(int texture);

/// The model's MJCF text. Textures are declared flat; BuildModel paints them.
/// Requires CheckWorld(world).
std::string WriteMjcf(const PhysicsWorld& world);

}  // namespace conav::sim
