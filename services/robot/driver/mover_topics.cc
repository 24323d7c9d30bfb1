#include "robot/driver/mover_topics.h"

#include <fmt/core.h>

#include <random>
#include <utility>

#include "common/bus/action.h"
#include "common/bus/publisher.h"
#include "common/bus/type_support_of.h"
#include "common/msg/convert.h"
#include "common/service/diagnostics.h"

namespace conav::robot {
namespace {

using Navigate = bus::NavigateToPose;

constexpr int kCancels = 100;  // at 20 Hz
constexpr auto kAnswerPatience = std::chrono::seconds(5);
/// Of a heading, of a robot that is not driven by velocities.
constexpr double kLeastHeadingToleranceRad = 0.1;

std_msgs::msg::Header WallHeader(const std::string& frame) {
  std_msgs::msg::Header header;
  header.stamp(RosWallTime(std::chrono::system_clock::now()));
  header.frame_id(frame);
  return header;
}

/// A goal on the plan in the frame of the robot's map.
geometry_msgs::msg::PoseStamped ToGoal(const Pose& plan_goal, const Pose& plan_from_robot,
                                       const std::string& frame) {
  const Pose goal = Inverse(plan_from_robot) * plan_goal;
  geometry_msgs::msg::PoseStamped message;
  message.header(WallHeader(frame));
  message.pose().position().x(goal.position.x_m);
  message.pose().position().y(goal.position.y_m);
  message.pose().orientation(ToQuaternion(goal.heading_rad));
  return message;
}

geometry_msgs::msg::Twist ToTwist(const Velocity& velocity) {
  geometry_msgs::msg::Twist twist;
  twist.linear().x(velocity.forward_mps);
  twist.angular().z(velocity.turn_rps);
  return twist;
}

bus::GoalId NewGoalId() {
  std::random_device random;
  bus::GoalId id{};
  for (auto& byte : id) byte = static_cast<std::uint8_t>(random());
  return id;
}

/// Nav2's action: it says what becomes of a goal, and takes it back.
class NavigateMover final : public Mover {
 public:
  using Client = bus::ActionClient<Navigate>;
  NavigateMover(std::shared_ptr<Client> client, const MoveConfig& move, const Pose& plan_from_robot,
                std::string frame, Missing missing)
      : Mover(std::move(missing)),
        client_(std::move(client)),
        heading_tolerance_rad_(std::max(kLeastHeadingToleranceRad, move.heading_tolerance_rad)),
        plan_from_robot_(plan_from_robot),
        frame_(std::move(frame)) {}

  void Begin(const Target& target, const Pose& at) override {
    target_ = target;
    cancels_left_ = 0;
    began_at_.reset();
    Navigate::Goal goal;
    goal.pose(ToGoal(GoalOf(target, at), plan_from_robot_, frame_));
    open_ = client_->Send(NewGoalId(), std::move(goal));
  }

  Progress Step(const Pose& at, Clock::TimePoint now) override {
    if (!began_at_) began_at_ = now;
    if (!open_) return {State::kFailed, "mover: the goal could not be sent"};
    const Client::Progress& progress = client_->Turn();
    if (progress.status == bus::GoalStatus::kUnknown && now - *began_at_ > kAnswerPatience) {
      return {State::kFailed, "mover: no answer to the goal; its RMW must be that of bus.vendor"};
    }
    const bool is_there = IsAt(target_, at, heading_tolerance_rad_);
    if (is_there && !target_.last) return {State::kArrived, ""};
    if (!bus::IsFinal(progress.status)) return {};
    open_ = false;
    if (progress.status == bus::GoalStatus::kCanceled) {
      return {State::kFailed, "mover: the goal was cancelled"};
    }
    if (progress.status == bus::GoalStatus::kAborted) {
      const int code = progress.result ? progress.result->error_code() : 0;
      return {State::kFailed, code != 0 ? fmt::format("mover: goal aborted, error code {}", code)
                                        : std::string("mover: goal aborted or rejected")};
    }
    if (is_there) return {State::kArrived, ""};
    return {State::kFailed,
            fmt::format("mover: calls the goal reached {:.2f} m away; its tolerance must be below "
                        "the command's {:.2f} m",
                        Distance(at.position, target_.place), target_.tolerance_m)};
  }

  void Cancel(const Pose&) override {
    if (!std::exchange(open_, false)) return;
    client_->Cancel();
    cancels_left_ = kCancels;
  }
  void Rest() override {
    // A server that had not yet taken the goal up when it was cancelled knows nothing of that.
    const bool final = bus::IsFinal(client_->Turn().status);
    if (cancels_left_ == 0) return;
    cancels_left_ = final ? 0 : cancels_left_ - 1;
    if (!final) client_->Cancel();
  }

 private:
  std::shared_ptr<Client> client_;
  double heading_tolerance_rad_;
  Pose plan_from_robot_;
  std::string frame_;
  Target target_;
  bool open_ = false;  // a goal is under way
  std::optional<Clock::TimePoint> began_at_;
  int cancels_left_ = 0;
};

template <class T>
std::shared_ptr<bus::Publisher<T>> Publish(bus::Participant& participant, const std::string& name) {
  return std::make_shared<bus::Publisher<T>>(participant,
                                             bus::Topic<T>{name, bus::kDefaultQos, "", ""});
}

/// Complains while nobody subscribes to what this publisher sends.
template <class T>
Mover::Missing Listeners(const std::shared_ptr<bus::Publisher<T>>& publisher,
                         const std::string& name) {
  return [publisher, name] {
    return publisher->matched_subscribers() > 0 ? std::string()
                                                : fmt::format("mover: nobody listens on {}", name);
  };
}

std::unique_ptr<Mover> MakePursuit(bus::Participant& participant, const MoveConfig& move,
                                   const std::string& name, const std::string& base) {
  const PursuitOptions options{move.speed_mps, move.turn_rps, move.acceleration_mps2,
                               move.heading_tolerance_rad};
  if (!move.stamped) {
    auto twists = Publish<geometry_msgs::msg::Twist>(participant, name);
    return std::make_unique<PursuitMover>(
        options, [twists](const Velocity& velocity) { bus::Send(*twists, ToTwist(velocity)); },
        Listeners(twists, name));
  }
  auto twists = Publish<geometry_msgs::msg::TwistStamped>(participant, name);
  return std::make_unique<PursuitMover>(
      options,
      [twists, base](const Velocity& velocity) {
        geometry_msgs::msg::TwistStamped message;
        message.header(WallHeader(base));
        message.twist(ToTwist(velocity));
        bus::Send(*twists, message);
      },
      Listeners(twists, name));
}

}  // namespace

std::string RobotTopicName(const DriverConfig& config, const std::string& key,
                           const std::string& name) {
  if (name.empty()) return "";
  std::string space = config.robot_namespace;
  while (space.starts_with('/')) space.erase(0, 1);
  while (space.ends_with('/')) space.pop_back();
  if (!space.empty()) space += '/';
  std::string full = name.starts_with('/') ? name : "/" + space + name;
  for (const auto own : {bus::kRobotMap.pattern, bus::kGoalPose.pattern, bus::kSnapshot.pattern,
                         bus::kRobotState.pattern, bus::kNavigateToPose.pattern}) {
    if (full != bus::FillName(own, config.robot)) continue;
    throw StartupError(
        fmt::format("driver.topics.{}: {} is conav's own name for {}; rename the robot's, or call "
                    "driver.robot otherwise",
                    key, full, config.robot));
  }
  return full;
}

std::unique_ptr<Mover> MakeMover(bus::Participant& participant, const DriverConfig& config,
                                 const Pose& plan_from_robot) {
  const RobotTopicsConfig& topics = config.topics;
  const MoveConfig& move = config.move;
  const std::string key(Name(move.by));
  const std::string name =
      RobotTopicName(config, key,
                     move.by == WayToMove::kCmdVel     ? topics.cmd_vel
                     : move.by == WayToMove::kGoalPose ? topics.goal_pose
                                                       : topics.navigate_to_pose);
  if (name.empty()) {
    throw StartupError(fmt::format("driver.topics.{0}: needed by move.by: {0}", key));
  }
  const std::string frame = config.frames.map;
  if (move.by == WayToMove::kCmdVel) {
    return MakePursuit(participant, move, name, config.frames.base);
  }
  if (move.by == WayToMove::kNavigateToPose) {
    auto client = std::make_shared<bus::ActionClient<Navigate>>(participant, name);
    return std::make_unique<NavigateMover>(client, move, plan_from_robot, frame, [client, name] {
      return client->IsReady() ? std::string() : fmt::format("mover: no action server {}", name);
    });
  }
  auto goals = Publish<geometry_msgs::msg::PoseStamped>(participant, name);
  return std::make_unique<GoalPoseMover>(
      std::max(kLeastHeadingToleranceRad, move.heading_tolerance_rad),
      [goals, plan_from_robot, frame](const Pose& goal) {
        bus::Send(*goals, ToGoal(goal, plan_from_robot, frame));
      },
      Listeners(goals, name));
}

std::function<void(double)> MakePan(bus::Participant& participant, const DriverConfig& config) {
  const std::string name = RobotTopicName(config, "pan", config.topics.pan);
  if (name.empty()) return nullptr;
  auto joint = Publish<std_msgs::msg::Float64>(participant, name);
  return [joint](double angle_rad) {
    std_msgs::msg::Float64 message;
    message.data(angle_rad);
    bus::Send(*joint, message);
  };
}

}  // namespace conav::robot
