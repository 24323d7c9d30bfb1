#pragma once

#include <string>

#include "common/bus/qos.h"

namespace conav::recorder {

/// The QoS that a topic's publishers offer, as rosbag2 (Humble and later) keeps it beside a topic:
/// a YAML list of one profile. `ros2 bag play` publishes with it.
std::string OfferedQosText(const bus::Qos& qos);

}  // namespace conav::recorder
