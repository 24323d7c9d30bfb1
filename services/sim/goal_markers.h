#pragma once

#include "ros2_interfaces.h"
#include "sim/episode/episode.h"

namespace conav::sim {

/// The goals as RViz draws them: one sphere per goal in its colour, frame "map".
visualization_msgs::msg::MarkerArray GoalMarkers(const Episode& episode);

}  // namespace conav::sim
