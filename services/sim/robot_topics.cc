#include "sim/robot_topics.h"

#include <cmath>

#include "common/bus/send.h"
#include "common/protocol/convert.h"
#include "sim/physics/camera.h"

namespace conav::sim {
namespace {

constexpr std::int64_t kStatePeriodNs = 500'000'000;

}  // namespace

RobotTopics::RobotTopics(bus::Participant& participant, const std::string& robot)
    : robot_(robot),
      state_(participant, bus::kRobotState, robot),
      map_(participant, bus::kRobotMap, robot),
      odometry_(participant, bus::kOdometry, robot),
      transforms_(participant, bus::kTransforms, robot),
      snapshot_(participant, bus::kSnapshot, robot),
      frame_(participant, bus::kCameraImage, robot),
      camera_info_(participant, bus::kCameraInfo, robot),
      command_(participant, bus::kRobotCommand, robot) {}

void RobotTopics::PublishChanges(const Episode& episode, int robot) {
  const MapUpdate& map = episode.map(robot);
  if (map.stamp != map_stamp_) {
    map_stamp_ = map.stamp;
    bus::Send(map_, ToMessage(map));
  }
  const std::uint64_t version = episode.state_version(robot);
  const bool old = episode.now().nanoseconds - state_stamp_.nanoseconds >= kStatePeriodNs;
  if (version == state_version_ && !old) return;
  state_version_ = version;
  state_stamp_ = episode.now();
  bus::Send(state_, ToMessage(episode.state(robot)));
}

void RobotTopics::PublishPose(const Episode& episode, int robot) {
  const RobotPose pose = episode.physics().pose(robot);
  const RobotMotion motion{pose.position, pose.heading_rad, pose.speed_mps, pose.yaw_rate_rps};
  bus::Send(odometry_, ToOdometry(episode.now(), robot_, motion));
  tf2_msgs::msg::TFMessage transforms;
  transforms.transforms().push_back(ToTransform(episode.now(), robot_, motion));
  bus::Send(transforms_, transforms);
}

void RobotTopics::PublishCameraInfo(SimTime stamp, int width, int height) {
  const double focal = height / 2.0 / std::tan(kCameraVerticalFovRad / 2.0);
  sensor_msgs::msg::CameraInfo info;
  info.header().stamp(ToMessage(stamp));
  info.header().frame_id(robot_ + "/camera_optical_frame");
  info.width(static_cast<std::uint32_t>(width));
  info.height(static_cast<std::uint32_t>(height));
  info.distortion_model("plumb_bob");
  info.d({0.0, 0.0, 0.0, 0.0, 0.0});
  info.k({focal, 0.0, width / 2.0, 0.0, focal, height / 2.0, 0.0, 0.0, 1.0});
  info.r({1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0});
  info.p({focal, 0.0, width / 2.0, 0.0, 0.0, focal, height / 2.0, 0.0, 0.0, 0.0, 1.0, 0.0});
  bus::Send(camera_info_, info);
}

void RobotTopics::PublishFrame(SimTime stamp, const std::vector<std::uint8_t>& jpeg) {
  sensor_msgs::msg::CompressedImage image;
  image.header().stamp(ToMessage(stamp));
  image.header().frame_id(robot_ + "/camera_optical_frame");
  image.format("jpeg");
  image.data(jpeg);
  bus::Send(frame_, image);
}

void RobotTopics::Publish(const Picture& picture) { bus::Send(snapshot_, ToMessage(picture)); }

std::vector<RobotCommand> RobotTopics::TakeCommands() {
  return command_.TakeValid([](const auto& message) { return ToDomain(message); });
}

}  // namespace conav::sim
