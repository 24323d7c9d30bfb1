#include "robot/driver/robot_topics.h"

#include <fmt/core.h>

#include <cmath>
#include <utility>

#include "common/bus/type_support_of.h"
#include "robot/driver/mover_topics.h"

namespace conav::robot {
namespace {

constexpr std::size_t kMostMapCells = std::size_t{1} << 26;
constexpr double kMostMetres = 1e6;

/// What a subscriber of sensors asks for: it matches any publisher.
constexpr bus::Qos kFrames{bus::Reliability::kBestEffort, bus::Durability::kVolatile, 100};
constexpr bus::Qos kNewestImage{bus::Reliability::kBestEffort, bus::Durability::kVolatile, 1};
constexpr bus::Qos kNewestMap{bus::Reliability::kReliable, bus::Durability::kVolatile, 1};

template <class T>
using Input = std::optional<bus::Subscriber<T>>;

template <class T>
void Connect(Input<T>& input, bus::Participant& participant, const std::string& name,
             const bus::Qos& qos) {
  if (!name.empty()) input.emplace(participant, bus::Topic<T>{name, qos, "", ""});
}

template <class T, class Newest>
void Keep(Input<T>& input, std::optional<Newest>& newest, Clock::TimePoint now) {
  if (!input) return;
  for (T& message : input->Take()) newest = Newest{std::move(message), now};
}

std::optional<Pose> ToPose(double x_m, double y_m, const geometry_msgs::msg::Quaternion& q) {
  const double yaw = std::atan2(2.0 * (q.w() * q.z() + q.x() * q.y()),
                                1.0 - 2.0 * (q.y() * q.y() + q.z() * q.z()));
  const bool valid =
      std::isfinite(yaw) && std::abs(x_m) < kMostMetres && std::abs(y_m) < kMostMetres;
  return valid ? std::optional(Pose{{x_m, y_m}, yaw}) : std::nullopt;
}

RawImage ToRaw(const sensor_msgs::msg::Image& message) {
  return {static_cast<int>(message.width()),
          static_cast<int>(message.height()),
          message.step(),
          message.encoding(),
          message.is_bigendian() != 0,
          message.data()};
}

/// Whether a foreign image's numbers can be sizes.
bool IsPlausible(const sensor_msgs::msg::Image& message) {
  constexpr std::uint32_t kMostPixels = 16384;
  return message.width() <= kMostPixels && message.height() <= kMostPixels;
}

}  // namespace

struct RobotTopics::Inputs {
  template <class T>
  struct Newest {
    T message;
    Clock::TimePoint received;
  };

  Input<nav_msgs::msg::Odometry> odometry;
  Input<tf2_msgs::msg::TFMessage> tf;
  Input<tf2_msgs::msg::TFMessage> tf_static;
  Input<nav_msgs::msg::OccupancyGrid> map;
  Input<sensor_msgs::msg::CameraInfo> camera_info;
  Input<sensor_msgs::msg::CompressedImage> compressed;
  Input<sensor_msgs::msg::Image> image;
  Input<sensor_msgs::msg::Image> depth;
  std::optional<Newest<nav_msgs::msg::OccupancyGrid>> newest_map;
  std::optional<Newest<sensor_msgs::msg::CompressedImage>> newest_compressed;
  std::optional<Newest<sensor_msgs::msg::Image>> newest_image;
  std::optional<Newest<sensor_msgs::msg::Image>> newest_depth;
};

RobotTopics::RobotTopics(bus::Participant& participant, const DriverConfig& config,
                         const Pose& plan_from_robot)
    : config_(config), plan_from_robot_(plan_from_robot), inputs_(std::make_unique<Inputs>()) {
  const RobotTopicsConfig& topics = config_.topics;
  if (topics.odometry.empty() && topics.tf.empty()) {
    throw StartupError("driver.topics: neither odometry nor tf says where the robot is");
  }
  if (topics.map.empty()) throw StartupError("driver.topics.map: the robot needs a map");
  Connect(inputs_->odometry, participant, RobotTopicName(config, "odometry", topics.odometry),
          kFrames);
  Connect(inputs_->tf, participant, RobotTopicName(config, "tf", topics.tf), kFrames);
  Connect(inputs_->tf_static, participant, RobotTopicName(config, "tf_static", topics.tf_static),
          {bus::Reliability::kReliable, bus::Durability::kTransientLocal, 100});
  Connect(inputs_->map, participant, RobotTopicName(config, "map", topics.map),
          config_.map.latched ? bus::kLatchedQos : kNewestMap);
  Connect(inputs_->camera_info, participant,
          RobotTopicName(config, "camera_info", topics.camera_info), kNewestImage);
  const std::string image = RobotTopicName(config, "image", topics.image);
  if (image.ends_with("/compressed")) {
    Connect(inputs_->compressed, participant, image, kNewestImage);
  } else {
    Connect(inputs_->image, participant, image, kNewestImage);
  }
  Connect(inputs_->depth, participant, RobotTopicName(config, "depth", topics.depth), kNewestImage);
}

RobotTopics::~RobotTopics() = default;

void RobotTopics::Receive(Clock::TimePoint now) {
  if (inputs_->tf_static) {
    for (const auto& message : inputs_->tf_static->Take()) Take(message, true, now);
  }
  if (inputs_->tf) {
    for (const auto& message : inputs_->tf->Take()) Take(message, false, now);
  }
  if (inputs_->odometry) {
    for (const auto& message : inputs_->odometry->Take()) Take(message, now);
  }
  Keep(inputs_->map, inputs_->newest_map, now);
  Keep(inputs_->compressed, inputs_->newest_compressed, now);
  Keep(inputs_->image, inputs_->newest_image, now);
  Keep(inputs_->depth, inputs_->newest_depth, now);
  if (!first_map_from_odom_) {
    const auto correction = frames_.Find(config_.frames.map, config_.frames.odom);
    if (correction) first_map_from_odom_ = correction->pose;
  }
}

void RobotTopics::Take(const nav_msgs::msg::Odometry& message, Clock::TimePoint now) {
  const auto& pose = message.pose().pose();
  const auto at = ToPose(pose.position().x(), pose.position().y(), pose.orientation());
  if (!at) {
    if (warnings_.Allow()) LOG_WARNING("odometry dropped", "reason", "a pose that is no number");
    return;
  }
  // Without TF odometry is all that there is: its frame is taken for the map's.
  const bool alone = config_.topics.tf.empty();
  const std::string child =
      alone || message.child_frame_id().empty() ? config_.frames.base : message.child_frame_id();
  const std::string parent = alone ? config_.frames.map : message.header().frame_id();
  frames_.Set(child, {parent, *at, now, false});
  const auto& twist = message.twist().twist();
  speed_mps_ = std::isfinite(twist.linear().x()) ? twist.linear().x() : 0.0;
  turn_rps_ = std::isfinite(twist.angular().z()) ? twist.angular().z() : 0.0;
}

void RobotTopics::Take(const tf2_msgs::msg::TFMessage& message, bool fixed, Clock::TimePoint now) {
  for (const auto& one : message.transforms()) {
    const auto& translation = one.transform().translation();
    const auto pose = ToPose(translation.x(), translation.y(), one.transform().rotation());
    if (pose) {
      frames_.Set(one.child_frame_id(), {one.header().frame_id(), *pose, now, fixed});
    } else if (warnings_.Allow()) {
      LOG_WARNING("transform dropped", "frame", one.child_frame_id().substr(0, 80), "reason",
                  "a pose that is no number");
    }
  }
}

std::optional<FrameTree::Found> RobotTopics::place() const {
  return frames_.Find(config_.frames.map, config_.frames.base);
}

std::optional<Pose> RobotTopics::drift() const {
  const auto at = place();
  const auto driven = frames_.Find(config_.frames.odom, config_.frames.base);
  if (!at || !driven || !first_map_from_odom_) return std::nullopt;
  return Inverse(*first_map_from_odom_ * driven->pose) * at->pose;
}

std::optional<RobotMap> RobotTopics::TakeMap() {
  if (!inputs_->newest_map) return std::nullopt;
  return Placed(std::move(std::exchange(inputs_->newest_map, std::nullopt)->message));
}

std::optional<RobotMap> RobotTopics::Placed(nav_msgs::msg::OccupancyGrid message) {
  const auto& info = message.info();
  const auto refuse = [&](const std::string& why) {
    if (warnings_.Allow()) LOG_WARNING("map refused", "reason", why);
    return std::nullopt;
  };
  const double resolution_m = static_cast<double>(info.resolution());
  if (!(resolution_m >= 0.001 && resolution_m <= 1000.0)) {
    return refuse(fmt::format("resolution = {} m is not in [0.001, 1000]", resolution_m));
  }
  const std::size_t cells = std::size_t{info.width()} * info.height();
  if (cells == 0 || cells > kMostMapCells || cells != message.data().size()) {
    return refuse(fmt::format("{} x {} cells, {} values; at most {} cells", info.width(),
                              info.height(), message.data().size(), kMostMapCells));
  }
  const auto origin = ToPose(info.origin().position().x(), info.origin().position().y(),
                             info.origin().orientation());
  if (!origin) return refuse("its origin is no number");
  const std::string& frame = message.header().frame_id();
  // Where nobody says so the frame is the map's, as of map_server without frame.
  const auto found = frames_.Find(config_.frames.map, frame.empty() ? config_.frames.map : frame);
  if (!found) {
    return refuse(fmt::format("no chain of frames from {} to its frame {}", config_.frames.map,
                              frame.substr(0, 80)));
  }
  return RobotMap{resolution_m, plan_from_robot_ * found->pose * *origin,
                  static_cast<int>(info.width()), static_cast<int>(info.height()),
                  std::move(message.data())};
}

std::optional<CameraLens> RobotTopics::TakeLens(sensor_msgs::msg::CameraInfo& message) {
  if (!inputs_->camera_info) return std::nullopt;
  std::optional<CameraLens> lens;
  for (auto& info : inputs_->camera_info->Take()) {
    const auto valid = ToDomain(info);
    if (valid) {
      lens = *valid;
      message = std::move(info);
    } else if (warnings_.Allow()) {
      LOG_WARNING("camera_info refused", "reason", valid.error().text);
    }
  }
  return lens;
}

std::optional<Result<Picture>> RobotTopics::PictureSince(Clock::TimePoint since,
                                                         int jpeg_quality) const {
  if (const auto& newest = inputs_->newest_compressed; newest && newest->received >= since) {
    return ToPicture(newest->message.data(), jpeg_quality);
  }
  if (const auto& newest = inputs_->newest_image; newest && newest->received >= since) {
    if (!IsPlausible(newest->message)) return Fail(ErrorCode::kMalformed, "image: its size");
    return ToPicture(ToRaw(newest->message), jpeg_quality);
  }
  return std::nullopt;
}

DepthProfile RobotTopics::DepthSince(Clock::TimePoint since) const {
  const auto& newest = inputs_->newest_depth;
  if (!newest || newest->received < since || !IsPlausible(newest->message)) return {};
  auto profile = ToDepthProfile(ToRaw(newest->message));
  if (profile) return *std::move(profile);
  LOG_WARNING("depth refused", "reason", profile.error().text);
  return {};
}

}  // namespace conav::robot
