#include "system/robot/standin_robot.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <numbers>
#include <opencv2/imgcodecs.hpp>

#include "common/bus/action.h"
#include "common/bus/publisher.h"
#include "common/bus/subscriber.h"
#include "common/bus/type_support_of.h"
#include "ros2_interfaces.h"

namespace conav::test {
namespace {

using std::chrono::steady_clock;
using Place = StandinRobot::Place;

constexpr double kRadius = 0.2;
constexpr double kLidarRange = 6.0;
constexpr int kRays = 240;
constexpr int kWidth = 160;
constexpr int kHeight = 120;
constexpr double kFocal = 100.0;  // pixels
constexpr double kStep = 0.05;
constexpr std::uint16_t kNoValidPath = 208;  // nav2_msgs/action/ComputePathToPose

double Wrapped(double angle) { return std::remainder(angle, 2.0 * std::numbers::pi); }

Place Times(const Place& a, const Place& b) {
  return {a.x + std::cos(a.yaw) * b.x - std::sin(a.yaw) * b.y,
          a.y + std::sin(a.yaw) * b.x + std::cos(a.yaw) * b.y, Wrapped(a.yaw + b.yaw)};
}

Place Inverted(const Place& a) {
  return {-std::cos(a.yaw) * a.x - std::sin(a.yaw) * a.y,
          std::sin(a.yaw) * a.x - std::cos(a.yaw) * a.y, -a.yaw};
}

builtin_interfaces::msg::Time Now() {
  const auto since = std::chrono::system_clock::now().time_since_epoch();
  const auto ns = std::chrono::nanoseconds(since).count();
  builtin_interfaces::msg::Time time;
  time.sec(static_cast<std::int32_t>(ns / 1'000'000'000));
  time.nanosec(static_cast<std::uint32_t>(ns % 1'000'000'000));
  return time;
}

std_msgs::msg::Header HeaderIn(const std::string& frame) {
  std_msgs::msg::Header header;
  header.stamp(Now());
  header.frame_id(frame);
  return header;
}

geometry_msgs::msg::Quaternion AroundZ(double yaw) {
  geometry_msgs::msg::Quaternion q;
  q.z(std::sin(yaw / 2.0));
  q.w(std::cos(yaw / 2.0));
  return q;
}

geometry_msgs::msg::TransformStamped Link(const std::string& parent, const std::string& child,
                                          const Place& at) {
  geometry_msgs::msg::TransformStamped link;
  link.header(HeaderIn(parent));
  link.child_frame_id(child);
  link.transform().translation().x(at.x);
  link.transform().translation().y(at.y);
  link.transform().rotation(AroundZ(at.yaw));
  return link;
}

}  // namespace

bool Building::IsWall(double x, double y) const { return Touches(x, y, 0.0); }

bool Building::Touches(double x, double y, double radius) const {
  return std::any_of(walls.begin(), walls.end(), [&](const Box& box) {
    const double dx = x - std::clamp(x, box.x0, box.x1);
    const double dy = y - std::clamp(y, box.y0, box.y1);
    return std::hypot(dx, dy) <= radius;
  });
}

double Building::Ray(double x, double y, double yaw, double range) const {
  constexpr double kFine = 0.02;
  for (double r = 0.0; r < range; r += kFine) {
    if (IsWall(x + r * std::cos(yaw), y + r * std::sin(yaw))) return r;
  }
  return range;
}

template <class T>
using Out = bus::Publisher<T>;
template <class T>
using In = std::optional<bus::Subscriber<T>>;

struct StandinRobot::Topics {
  Topics(const bus::ParticipantOptions& options, const Options& robot)
      : participant("robot_" + robot.name, options),
        odom(participant, {Name(robot, odom_name, "/odom"), {}, "", ""}),
        tf(participant, {Name(robot, tf_name, robot.prefixed_frames ? "//tf" : "/tf"),
                         bus::kTransformQos, "", ""}),
        tf_static(participant,
                  {Name(robot, static_name, robot.prefixed_frames ? "//tf_static" : "/tf_static"),
                   bus::kLatchedQos, "", ""}),
        map(participant, {Name(robot, map_name, "/map"), bus::kLatchedQos, "", ""}),
        info(participant,
             {Name(robot, info_name, "/camera/camera_info"), bus::kSensorQos, "", ""}) {
    if (robot.raw_image) {
      raw.emplace(participant,
                  bus::Topic<sensor_msgs::msg::Image>{Name(robot, raw_name, "/camera/image_raw"),
                                                      bus::kSensorQos, "", ""});
      depth.emplace(participant,
                    bus::Topic<sensor_msgs::msg::Image>{Name(robot, depth_name, "/camera/depth"),
                                                        bus::kSensorQos, "", ""});
    } else {
      jpeg.emplace(participant, bus::Topic<sensor_msgs::msg::CompressedImage>{
                                    Name(robot, jpeg_name, "/camera/image_raw/compressed"),
                                    bus::kSensorQos, "", ""});
    }
    if (robot.has_pan) {
      pan.emplace(participant, bus::Topic<std_msgs::msg::Float64>{
                                   Name(robot, pan_name, "/pan/command"), {}, "", ""});
    }
  }
  /// In its name space; after // not. `kept` outlives the topic, which is a view.
  static std::string_view Name(const Options& robot, std::string& kept, const std::string& rest) {
    kept = rest.starts_with("//") ? rest.substr(1) : "/" + robot.name + rest;
    return kept;
  }
  void ConnectBase(const Options& robot) {
    if (robot.navigates) {
      Name(robot, base_name, "/navigate_to_pose");
      action.emplace(participant, bus::Action<bus::NavigateToPose>{base_name, "", "", ""}, "");
    } else if (robot.follows_goals) {
      goal.emplace(participant, bus::Topic<geometry_msgs::msg::PoseStamped>{
                                    Name(robot, base_name, "/goal_pose"), {}, "", ""});
    } else if (robot.stamped) {
      stamped.emplace(participant, bus::Topic<geometry_msgs::msg::TwistStamped>{
                                       Name(robot, base_name, "/cmd_vel"), {}, "", ""});
    } else {
      twist.emplace(participant, bus::Topic<geometry_msgs::msg::Twist>{
                                     Name(robot, base_name, "/cmd_vel"), {}, "", ""});
    }
  }
  void DisconnectBase() {
    action.reset();
    executing.reset();
    goal.reset();
    stamped.reset();
    twist.reset();
  }

  std::string odom_name, tf_name, static_name, map_name, info_name, raw_name, depth_name, jpeg_name,
      pan_name, base_name;
  bus::Participant participant;
  Out<nav_msgs::msg::Odometry> odom;
  Out<tf2_msgs::msg::TFMessage> tf;
  Out<tf2_msgs::msg::TFMessage> tf_static;
  Out<nav_msgs::msg::OccupancyGrid> map;
  Out<sensor_msgs::msg::CameraInfo> info;
  std::optional<Out<sensor_msgs::msg::Image>> raw, depth;
  std::optional<Out<sensor_msgs::msg::CompressedImage>> jpeg;
  In<geometry_msgs::msg::Twist> twist;
  In<geometry_msgs::msg::TwistStamped> stamped;
  In<geometry_msgs::msg::PoseStamped> goal;
  In<std_msgs::msg::Float64> pan;
  std::optional<bus::ActionServer<bus::NavigateToPose>> action;
  std::optional<bus::GoalId> executing;
};

/// What its lidar has seen, by cells of its map's frame.
struct StandinRobot::Map {
  std::map<std::pair<int, int>, std::int8_t> cells;  // column, row
};

StandinRobot::StandinRobot(const bus::ParticipantOptions& bus, const Building& building,
                           const Options& options)
    : building_(building),
      options_(options),
      bus_(bus),
      topics_(std::make_unique<Topics>(bus, options)),
      map_(std::make_unique<Map>()),
      x_(options.x),
      y_(options.y),
      yaw_(options.yaw) {
  topics_->ConnectBase(options_);
  thread_ = std::thread([this] { Run(); });
}

StandinRobot::~StandinRobot() {
  stop_ = true;
  thread_.join();
}

Place StandinRobot::place() const { return {x_, y_, yaw_}; }

void StandinRobot::Run() {
  auto next = steady_clock::now();
  while (!stop_) {
    Step(kStep);
    next += std::chrono::milliseconds(50);
    std::this_thread::sleep_until(next);
  }
}

void StandinRobot::Step(double seconds) {
  if (faults.base_gone) topics_->DisconnectBase();
  const bool connected = topics_->action || topics_->goal || topics_->stamped || topics_->twist;
  if (!faults.base_gone && !connected) topics_->ConnectBase(options_);
  const auto now = steady_clock::now();
  const auto command = [&](const geometry_msgs::msg::Twist& twist) {
    forward_ = twist.linear().x();
    turn_ = twist.angular().z();
    commanded_at_ = now;
  };
  if (topics_->twist) {
    for (const auto& twist : topics_->twist->Take()) command(twist);
  }
  if (topics_->stamped) {
    for (const auto& message : topics_->stamped->Take()) command(message.twist());
  }
  if (topics_->action) {
    Navigate();
    Follow();
    commanded_at_ = now;
  }
  if (topics_->goal) {
    for (const auto& message : topics_->goal->Take()) {
      const auto& q = message.pose().orientation();
      goal_ = Place{message.pose().position().x(), message.pose().position().y(),
                    2.0 * std::atan2(q.z(), q.w())};
      ++goals_received_;
    }
    Follow();
    commanded_at_ = now;
  }
  if (topics_->pan) {
    for (const auto& message : topics_->pan->Take()) pan_ = message.data();
  }
  // A base stands when nobody commands it for half a second.
  if (now - commanded_at_ > std::chrono::milliseconds(500)) forward_ = turn_ = 0.0;
  Move(seconds);
  if (ticks_ % 20 == 0)
    map_from_odom_ =
        Times(Times(Inverted({options_.x, options_.y, options_.yaw}), place()), Inverted(odom_));
  if (faults.jumps.exchange(false)) jumped_until_ = now + std::chrono::milliseconds(1500);
  SendPose();
  if (ticks_ % 5 == 0) Scan();
  if (ticks_ % 10 == 0 && !faults.map_silent) SendMap();
  if (ticks_ % 4 == 0 && !faults.camera_silent) SendPicture();
  ++ticks_;
}

void StandinRobot::Move(double seconds) {
  // Motors need a moment.
  speed_ += std::clamp(forward_ - speed_, -2.0 * seconds, 2.0 * seconds);
  rate_ += std::clamp(turn_ - rate_, -6.0 * seconds, 6.0 * seconds);
  if (faults.wheels_blocked) speed_ = rate_ = 0.0;
  const double way = speed_ * seconds;
  const double yaw = yaw_ + rate_ * seconds;
  const double x = x_ + way * std::cos(yaw);
  const double y = y_ + way * std::sin(yaw);
  const bool touches = building_.Touches(x, y, kRadius);
  if (touches && !touched_) ++bumps_;
  touched_ = touches;
  yaw_ = Wrapped(yaw);
  if (touches) {
    speed_ = 0.0;
    return;
  }
  x_ = x;
  y_ = y;
  // Its wheels count three percent too much, and it pulls to the left.
  odom_.yaw = Wrapped(odom_.yaw + rate_ * seconds + 0.02 * way);
  odom_.x += 1.03 * way * std::cos(odom_.yaw);
  odom_.y += 1.03 * way * std::sin(odom_.yaw);
}

void StandinRobot::Follow() {
  forward_ = turn_ = 0.0;
  if (!goal_) return;
  const Place at = Times(map_from_odom_, odom_);
  const double left = std::hypot(goal_->x - at.x, goal_->y - at.y);
  const double towards = Wrapped(std::atan2(goal_->y - at.y, goal_->x - at.x) - at.yaw);
  if (left < 0.08) {
    const double error = Wrapped(goal_->yaw - at.yaw);
    if (std::abs(error) < 0.05) goal_.reset();
    turn_ = std::clamp(2.0 * error, -1.5, 1.5);
    return;
  }
  turn_ = std::clamp(2.5 * towards, -1.5, 1.5);
  if (std::abs(towards) < 0.4) forward_ = std::min(0.8, 1.2 * left);
}

void StandinRobot::Navigate() {
  auto& action = *topics_->action;
  auto& executing = topics_->executing;
  using bus::GoalStatus;
  const auto finish = [&](GoalStatus status, std::uint16_t error_code = 0) {
    nav2_msgs::action::NavigateToPose_Result result;
    result.error_code(error_code);
    action.Finish(*executing, status, result);
    executing.reset();
  };
  for (const auto& offer : action.Take()) {
    if (!action.Accept(offer, Now())) continue;
    if (executing) finish(GoalStatus::kAborted);
    executing = offer.id;
    const auto& pose = offer.goal.pose().pose();
    goal_ = Place{pose.position().x(), pose.position().y(),
                  2.0 * std::atan2(pose.orientation().z(), pose.orientation().w())};
    ++goals_received_;
  }
  if (!executing) return;
  if (action.status(*executing) == GoalStatus::kCanceling) {
    goal_.reset();
    finish(GoalStatus::kCanceled);
  } else if (faults.aborts) {
    goal_.reset();
    finish(GoalStatus::kAborted, kNoValidPath);
  } else if (!goal_) {
    finish(GoalStatus::kSucceeded);
  }
}

void StandinRobot::Scan() {
  // A SLAM that works: its scans are where the robot is, in a frame that begins at its start.
  const Place start{options_.x, options_.y, options_.yaw};
  const Place at = Times(Inverted(start), place());
  const double cell = options_.map_resolution;
  const auto index = [&](double metres) { return static_cast<int>(std::floor(metres / cell)); };
  for (int i = 0; i < kRays; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / kRays;
    const double range = building_.Ray(x_, y_, yaw_ + angle, kLidarRange);
    const double cosine = std::cos(at.yaw + angle);
    const double sine = std::sin(at.yaw + angle);
    for (double r = 0.0; r < range - cell; r += cell / 2.0) {
      auto& value = map_->cells.try_emplace({index(at.x + r * cosine), index(at.y + r * sine)}, 0)
                        .first->second;
      value = static_cast<std::int8_t>(std::max(0, value - 10));
    }
    if (range >= kLidarRange) continue;
    map_->cells[{index(at.x + range * cosine), index(at.y + range * sine)}] = 100;
  }
}

void StandinRobot::SendPose() {
  const std::string prefix = options_.prefixed_frames ? options_.name + "/" : "";
  if (!faults.odometry_silent) {
    nav_msgs::msg::Odometry message;
    message.header(HeaderIn(prefix + "odom"));
    message.child_frame_id(prefix + "base_footprint");
    message.pose().pose().position().x(odom_.x);
    message.pose().pose().position().y(odom_.y);
    message.pose().pose().orientation(AroundZ(odom_.yaw));
    message.twist().twist().linear().x(speed_);
    message.twist().twist().angular().z(rate_);
    bus::Send(topics_->odom, message);
    tf2_msgs::msg::TFMessage links;
    links.transforms().push_back(Link(prefix + "odom", prefix + "base_footprint", odom_));
    bus::Send(topics_->tf, links);
  }
  if (!faults.correction_silent) {
    Place correction = map_from_odom_;
    if (steady_clock::now() < jumped_until_) correction.x += 3.0;
    tf2_msgs::msg::TFMessage links;
    links.transforms().push_back(Link(prefix + "map", prefix + "odom", correction));
    bus::Send(topics_->tf, links);
  }
  if (ticks_ > 0) return;
  tf2_msgs::msg::TFMessage links;
  links.transforms().push_back(Link(prefix + "base_footprint", prefix + "base_link", {0, 0, 0}));
  bus::Send(topics_->tf_static, links);
}

void StandinRobot::SendMap() {
  if (map_->cells.empty()) return;
  int first_column = 1 << 20, first_row = 1 << 20, last_column = -first_column,
      last_row = -first_row;
  for (const auto& [at, value] : map_->cells) {
    first_column = std::min(first_column, at.first);
    last_column = std::max(last_column, at.first);
    first_row = std::min(first_row, at.second);
    last_row = std::max(last_row, at.second);
  }
  const int columns = last_column - first_column + 1;
  const int rows = last_row - first_row + 1;
  nav_msgs::msg::OccupancyGrid message;
  message.header(HeaderIn((options_.prefixed_frames ? options_.name + "/" : "") + "map"));
  message.info().map_load_time(Now());
  message.info().resolution(static_cast<float>(options_.map_resolution));
  message.info().width(static_cast<std::uint32_t>(columns));
  message.info().height(static_cast<std::uint32_t>(rows));
  message.info().origin().position().x(first_column * options_.map_resolution);
  message.info().origin().position().y(first_row * options_.map_resolution);
  message.info().origin().orientation().w(1.0);
  message.data().assign(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows), -1);
  for (const auto& [at, value] : map_->cells) {
    message.data()[static_cast<std::size_t>(at.second - first_row) *
                       static_cast<std::size_t>(columns) +
                   static_cast<std::size_t>(at.first - first_column)] = value;
  }
  bus::Send(topics_->map, message);
}

void StandinRobot::SendPicture() {
  cv::Mat picture(kHeight, kWidth, CV_8UC3, cv::Scalar(200, 120, 60));
  std::vector<float> depth(static_cast<std::size_t>(kWidth) * kHeight);
  for (int column = 0; column < kWidth; ++column) {
    const double aside = (kWidth / 2.0 - column - 0.5) / kFocal;  // to the left
    const double angle = std::atan(aside);
    const double ahead = std::cos(angle) * building_.Ray(x_, y_, yaw_ + pan_ + angle, 20.0);
    const double half = std::min(kHeight / 2.0, 0.5 * kFocal / std::max(0.05, ahead));
    for (int row = 0; row < kHeight; ++row) {
      auto& pixel = picture.at<cv::Vec3b>(row, column);
      const bool wall = std::abs(row - kHeight / 2.0) < half;
      if (wall)
        pixel = {90, 90, static_cast<std::uint8_t>(std::clamp(255.0 - 20.0 * ahead, 40.0, 255.0))};
      if (!wall && row > kHeight / 2) pixel = {80, 110, 80};
      depth[static_cast<std::size_t>(row) * kWidth + static_cast<std::size_t>(column)] =
          static_cast<float>(ahead);
    }
  }
  const auto header =
      HeaderIn((options_.prefixed_frames ? options_.name + "/" : "") + "camera_optical_frame");
  sensor_msgs::msg::CameraInfo info;
  info.header(header);
  info.width(kWidth);
  info.height(kHeight);
  info.distortion_model("plumb_bob");
  info.k({kFocal, 0.0, kWidth / 2.0, 0.0, kFocal, kHeight / 2.0, 0.0, 0.0, 1.0});
  bus::Send(topics_->info, info);
  if (!options_.raw_image) {
    sensor_msgs::msg::CompressedImage message;
    message.header(header);
    message.format("bgr8; jpeg compressed bgr8");
    cv::imencode(".jpg", picture, message.data());
    bus::Send(*topics_->jpeg, message);
    return;
  }
  sensor_msgs::msg::Image message;
  message.header(header);
  message.width(kWidth);
  message.height(kHeight);
  message.encoding("bgr8");
  message.step(3 * kWidth);
  message.data().assign(picture.data, picture.data + 3 * kWidth * kHeight);
  bus::Send(*topics_->raw, message);
  message.encoding("32FC1");
  message.step(4 * kWidth);
  message.data().resize(depth.size() * sizeof(float));
  std::memcpy(message.data().data(), depth.data(), message.data().size());
  bus::Send(*topics_->depth, message);
}

}  // namespace conav::test
