#include "sim/robot_topics.h"

#include <cmath>

#include "common/grid/frames.h"
#include "common/grid/visibility.h"
#include "common/msg/convert.h"

namespace conav::sim {
namespace {

constexpr std::chrono::milliseconds kStatePeriod{500};  // of simulation time
constexpr std::chrono::seconds kHeartbeat{1};           // of wall time

}  // namespace

RobotTopics::RobotTopics(bus::Participant& participant, const std::string& robot, int width,
                         int height)
    : participant_(participant),
      robot_(robot),
      width_(width),
      height_(height),
      state_(participant, robot),
      map_(participant, bus::kRobotMap, bus::kRobotMapChanges, robot),
      snapshot_(participant, bus::kSnapshot, robot),
      frame_(participant, bus::kCameraImage, robot),
      camera_info_(participant, bus::kCameraInfo, robot),
      description_(participant, bus::kRobotDescription, robot),
      command_(participant, bus::kRobotCommand, robot),
      stop_(participant, bus::kStopOrder, robot) {}

void RobotTopics::Restart() {
  command_.Take();
  state_version_ = 0;
  state_stamp_ = {};
  state_.Restart();
  map_stamp_ = {-1};
  goals_stamp_ = {};
}

void RobotTopics::PublishChanges(const Episode& episode, int robot, Clock::TimePoint now) {
  const MapUpdate& map = episode.map(robot);
  if (map.stamp != map_stamp_) {
    map_stamp_ = map.stamp;
    map_.Send(ToMessage(map));
  }
  const std::uint64_t version = episode.state_version(robot);
  const bool old =
      episode.now() >= state_stamp_ + kStatePeriod || now - state_sent_at_ >= kHeartbeat;
  if (version == state_version_ && !old) return;
  state_version_ = version;
  state_stamp_ = episode.now();
  state_sent_at_ = now;
  const RobotState state = episode.state(robot);
  if (state.goals_stamp != goals_stamp_) {
    goals_stamp_ = state.goals_stamp;
    if (!robot_goals_) robot_goals_.emplace(participant_, bus::kRobotGoals, robot_);
    bus::Send(*robot_goals_, ToMessage(GoalsOf(state, episode.goal_tolerance_m())));
  }
  state_.Publish(state, now);
}

void RobotTopics::PublishDescription(const std::string& urdf) {
  std_msgs::msg::String message;
  message.data(urdf);
  bus::Send(description_, message);
}

void RobotTopics::PublishCameraInfo(SimTime stamp) {
  const double focal = height_ / 2.0 / std::tan(kCameraVerticalFovRad / 2.0);
  sensor_msgs::msg::CameraInfo info;
  info.header().stamp(ToMessage(stamp));
  info.header().frame_id(std::string(kOpticalFrame));
  info.width(static_cast<std::uint32_t>(width_));
  info.height(static_cast<std::uint32_t>(height_));
  info.distortion_model("plumb_bob");
  info.d({0.0, 0.0, 0.0, 0.0, 0.0});
  info.k({focal, 0.0, width_ / 2.0, 0.0, focal, height_ / 2.0, 0.0, 0.0, 1.0});
  info.r({1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0});
  info.p({focal, 0.0, width_ / 2.0, 0.0, 0.0, focal, height_ / 2.0, 0.0, 0.0, 0.0, 1.0, 0.0});
  bus::Send(camera_info_, info);
}

void RobotTopics::PublishFrame(SimTime stamp, const std::vector<std::uint8_t>& jpeg) {
  PublishCameraInfo(stamp);
  sensor_msgs::msg::CompressedImage image;
  image.header().stamp(ToMessage(stamp));
  image.header().frame_id(std::string(kOpticalFrame));
  image.format("jpeg");
  image.data(jpeg);
  bus::Send(frame_, image);
}

void RobotTopics::Publish(const Snapshot& snapshot) { bus::Send(snapshot_, ToMessage(snapshot)); }

std::vector<StopOrder> RobotTopics::TakeStopOrders() {
  return stop_.TakeValid([](const auto& message) { return ToDomain(message); });
}

std::vector<RobotCommand> RobotTopics::TakeCommands() {
  return command_.TakeValid([](const auto& message) { return ToDomain(message); });
}

}  // namespace conav::sim
