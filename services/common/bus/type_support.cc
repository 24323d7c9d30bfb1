#include "common/bus/type_support.h"

#include "common/bus/topics.h"
#include "ros2_graph.h"

namespace conav::bus {

std::string RosTypeName(std::string_view cpp_name) {
  const auto separator = cpp_name.rfind("::");
  if (separator == std::string_view::npos) return "dds_::" + std::string(cpp_name) + "_";
  const auto after = separator + 2;
  return std::string(cpp_name.substr(0, after))
      .append("dds_::")
      .append(cpp_name.substr(after))
      .append("_");
}

// ros_discovery_info has two layouts under one DDS name.
template <>
const TypeSupport& TypeSupportOf<ros_graph_jazzy::msg::ParticipantEntitiesInfo>() {
  static const TypeSupport support = MakeTypeSupport<ros_graph_jazzy::msg::ParticipantEntitiesInfo>(
      "rmw_dds_common::msg::dds_::ParticipantEntitiesInfo_");
  return support;
}

template <>
const TypeSupport& TypeSupportOf<ros_graph_humble::msg::ParticipantEntitiesInfo>() {
  static const TypeSupport support =
      MakeTypeSupport<ros_graph_humble::msg::ParticipantEntitiesInfo>(
          "rmw_dds_common::msg::dds_::ParticipantEntitiesInfo_");
  return support;
}

template const TypeSupport& TypeSupportOf<nav_msgs::msg::OccupancyGrid>();
template const TypeSupport& TypeSupportOf<nav_msgs::msg::Odometry>();
template const TypeSupport& TypeSupportOf<nav_msgs::msg::Path>();
template const TypeSupport& TypeSupportOf<tf2_msgs::msg::TFMessage>();
template const TypeSupport& TypeSupportOf<sensor_msgs::msg::CompressedImage>();
template const TypeSupport& TypeSupportOf<sensor_msgs::msg::CameraInfo>();
template const TypeSupport& TypeSupportOf<geometry_msgs::msg::PoseStamped>();
template const TypeSupport& TypeSupportOf<visualization_msgs::msg::MarkerArray>();
template const TypeSupport& TypeSupportOf<diagnostic_msgs::msg::DiagnosticArray>();
template const TypeSupport& TypeSupportOf<rcl_interfaces::msg::Log>();
template const TypeSupport& TypeSupportOf<rosgraph_msgs::msg::Clock>();
template const TypeSupport& TypeSupportOf<conav_msgs::msg::RobotState>();
template const TypeSupport& TypeSupportOf<conav_msgs::msg::RobotCommand>();
template const TypeSupport& TypeSupportOf<conav_msgs::msg::Snapshot>();
template const TypeSupport& TypeSupportOf<conav_msgs::msg::DriveOrder>();
template const TypeSupport& TypeSupportOf<conav_msgs::msg::StopOrder>();
template const TypeSupport& TypeSupportOf<conav_msgs::msg::Guidance>();
template const TypeSupport& TypeSupportOf<conav_msgs::msg::BeliefMap>();
template const TypeSupport& TypeSupportOf<conav_msgs::msg::OperatorRequest>();
template const TypeSupport& TypeSupportOf<conav_msgs::msg::OperatorReply>();
template const TypeSupport& TypeSupportOf<conav_msgs::msg::AttentionRequest>();
template const TypeSupport& TypeSupportOf<conav_msgs::msg::AttentionQueue>();
template const TypeSupport& TypeSupportOf<conav_msgs::msg::SearchReport>();
template const TypeSupport& TypeSupportOf<conav_msgs::msg::PlannerLease>();
template const TypeSupport& TypeSupportOf<conav_msgs::msg::IntendedPath>();
template const TypeSupport& TypeSupportOf<conav_msgs::msg::PerceptionRequest>();
template const TypeSupport& TypeSupportOf<conav_msgs::msg::PerceptionReply>();

}  // namespace conav::bus
