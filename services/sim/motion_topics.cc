#include "sim/motion_topics.h"

#include <algorithm>
#include <cmath>

#include "common/grid/frames.h"
#include "common/msg/convert.h"
#include "sim/physics/robot_body.h"

namespace conav::sim {
namespace {

constexpr std::int64_t kSubstepNs = 5'000'000;
static_assert(kSubstepNs == static_cast<std::int64_t>(kPhysicsStepS * 1e9));

geometry_msgs::msg::TransformStamped Moving(SimTime stamp, std::string_view robot,
                                            const RobotPose& pose) {
  return ToTransform(stamp, robot, kOdometryFrame, kBaseFrame,
                     {pose.position.x_m, pose.position.y_m, 0.0, 0.0, 0.0, pose.heading_rad});
}

void AddFixed(SimTime stamp, std::string_view robot, tf2_msgs::msg::TFMessage& message) {
  auto& transforms = message.transforms();
  transforms.push_back(ToTransform(stamp, robot, kMapFrame, kOdometryFrame, {}));
  for (const FixedFrame& frame : CameraFrames()) {
    transforms.push_back(ToTransform(stamp, robot, frame.parent, frame.child, frame.pose));
  }
}

template <class T>
bool Asks(const std::optional<bus::Publisher<T>>& publisher) {
  return publisher && publisher->demanding_subscribers() > 0;
}

}  // namespace

MotionTopics::Robot::Robot(bus::Participant& participant, const SimConfig& config,
                           const std::string& robot)
    : name(robot), odometry(participant, bus::kOdometry, robot) {
  if (!config.tf.robot) return;
  transforms.emplace(participant, bus::kTransforms, robot);
  fixed.emplace(participant, bus::kFixedTransforms, robot);
}

MotionTopics::MotionTopics(bus::Participant& participant, const SimConfig& config,
                           const RobotWorld& physics)
    : physics_(physics),
      speed_(config.speed),
      period_substeps_(
          std::max(1, static_cast<int>(std::lround(1.0 / (config.motion_hz * kPhysicsStepS))))) {
  if (config.publish_clock) clock_.emplace(participant, bus::kClock);
  for (const std::string& robot : config.robots) {
    robots_.push_back(std::make_unique<Robot>(participant, config, robot));
  }
  if (!config.tf.fleet) return;
  fleet_.emplace(participant, bus::kFleetTransforms);
  fleet_fixed_.emplace(participant, bus::kFleetFixedTransforms);
}

void MotionTopics::PublishFixed(SimTime stamp) {
  tf2_msgs::msg::TFMessage fleet;
  for (const auto& robot : robots_) {
    AddFixed(stamp, robot->name, fleet);
    tf2_msgs::msg::TFMessage plain;
    AddFixed(stamp, "", plain);
    if (robot->fixed) bus::Send(*robot->fixed, plain);
  }
  if (fleet_fixed_) bus::Send(*fleet_fixed_, fleet);
}

bool MotionTopics::SomebodyAsks() const {
  return Asks(clock_) || Asks(fleet_) || std::ranges::any_of(robots_, [](const auto& robot) {
           return robot->odometry.demanding_subscribers() > 0 || Asks(robot->transforms);
         });
}

bool MotionTopics::Begin(SimTime begin, Clock::TimePoint wall_begin) {
  for (const Moment& moment : waiting_) Publish(moment);
  waiting_.clear();
  step_begin_ = begin;
  wall_begin_ = wall_begin;
  is_dense_ = period_substeps_ < kSubsteps && SomebodyAsks();
  return is_dense_;
}

void MotionTopics::Sample(int substep) {
  const SimTime stamp{step_begin_.nanoseconds + substep * kSubstepNs};
  if (stamp.nanoseconds % (period_substeps_ * kSubstepNs) != 0) return;
  Moment moment = MomentAt(stamp);
  moment.ends_step = false;
  waiting_.push_back(std::move(moment));
}

void MotionTopics::End(Clock::TimePoint now) {
  waiting_.push_back(MomentAt({step_begin_.nanoseconds + kSubsteps * kSubstepNs}));
  if (speed_ <= 0.0 || !is_dense_) now = Clock::TimePoint::max();
  PublishDue(now);
}

MotionTopics::Moment MotionTopics::MomentAt(SimTime stamp) const {
  Moment moment{stamp, {}};
  for (int robot = 0; robot < physics_.robot_count(); ++robot) {
    moment.poses.push_back(physics_.pose(robot));
  }
  if (speed_ > 0.0) {
    const std::chrono::duration<double, std::nano> since(
        static_cast<double>(stamp.nanoseconds - step_begin_.nanoseconds) / speed_);
    moment.due = wall_begin_ + std::chrono::duration_cast<Clock::TimePoint::duration>(since);
  }
  return moment;
}

void MotionTopics::PublishDue(Clock::TimePoint now) {
  while (!waiting_.empty() && waiting_.front().due <= now) {
    Publish(waiting_.front());
    waiting_.pop_front();
  }
}

std::optional<Clock::TimePoint> MotionTopics::next_due() const {
  if (waiting_.empty()) return std::nullopt;
  return waiting_.front().due;
}

void MotionTopics::PublishNow(SimTime stamp) { Publish(MomentAt(stamp)); }

void MotionTopics::Publish(const Moment& moment) {
  if (clock_ && (moment.ends_step || Asks(clock_))) {
    rosgraph_msgs::msg::Clock clock;
    clock.clock(ToMessage(moment.stamp));
    bus::Send(*clock_, clock);
  }
  tf2_msgs::msg::TFMessage fleet;
  for (std::size_t i = 0; i < robots_.size(); ++i) {
    Robot& robot = *robots_[i];
    const RobotPose& pose = moment.poses[i];
    if (moment.ends_step || robot.odometry.demanding_subscribers() > 0) {
      bus::Send(robot.odometry, ToOdometry(moment.stamp, {pose.position, pose.heading_rad,
                                                          pose.speed_mps, pose.yaw_rate_rps}));
    }
    if (robot.transforms && (moment.ends_step || Asks(robot.transforms))) {
      tf2_msgs::msg::TFMessage plain;
      plain.transforms().push_back(Moving(moment.stamp, "", pose));
      bus::Send(*robot.transforms, plain);
    }
    fleet.transforms().push_back(Moving(moment.stamp, robot.name, pose));
  }
  if (fleet_ && (moment.ends_step || Asks(fleet_))) bus::Send(*fleet_, fleet);
}

}  // namespace conav::sim
