#pragma once

#include <deque>
#include <memory>
#include <optional>
#include <vector>

#include "common/bus/publisher.h"
#include "common/bus/topics.h"
#include "common/runtime/clock.h"
#include "sim/config.h"
#include "sim/physics/robot_world.h"

// One user: the service. Who gets poses when is a thing of its own.

namespace conav::sim {

/// What changes with the physics: /clock, and odometry and transforms of all robots of one world.
///
/// Publishes each control step, 4 times a second of simulation time; on a topic with a subscriber
/// that asks for the full rate also poses of the physics steps between, on multiples of
/// 1 / motion_hz. Nothing else of the simulator depends on who listens: same commands, same run.
///
/// As fast as possible (speed 0) all goes out at the end of the step. In real time the physics of a
/// step is done at its begin, for commands to have the whole step; then what a listener of the full
/// rate gets is spread over the step, and its clock and poses come up to a step later than the
/// state of the same stamp.
///
/// map -> odom is the identity, since this odometry has no drift; it and the camera's frames are
/// fixed transforms, latched at the start.
class MotionTopics {
 public:
  MotionTopics(bus::Participant& participant, const SimConfig& config, const RobotWorld& physics);

  /// The fixed transforms.
  void PublishFixed(SimTime stamp);

  /// Before a control step at simulation time `begin`, which real time reaches at `wall_begin`:
  /// publishes what is left of the last one. True when somebody asks for more than its end.
  bool Begin(SimTime begin, Clock::TimePoint wall_begin);
  /// In such a step, after physics step `substep` of it (1 to kSubsteps - 1).
  void Sample(int substep);
  /// After the step. Publishes it, or in real time what is due at `now`.
  void End(Clock::TimePoint now);

  void PublishDue(Clock::TimePoint now);
  std::optional<Clock::TimePoint> next_due() const;

  /// From the next step on.
  void SetSpeed(double speed) { speed_ = speed; }

  /// Where the robots are now.
  void PublishNow(SimTime stamp);

 private:
  struct Robot {
    Robot(bus::Participant& participant, const SimConfig& config, const std::string& robot);

    std::string name;
    bus::Publisher<nav_msgs::msg::Odometry> odometry;
    std::optional<bus::Publisher<tf2_msgs::msg::TFMessage>> transforms;
    std::optional<bus::Publisher<tf2_msgs::msg::TFMessage>> fixed;
  };
  struct Moment {
    SimTime stamp;
    std::vector<RobotPose> poses;
    bool ends_step = true;  // else only for those who ask for the full rate
    Clock::TimePoint due{};
  };

  Moment MomentAt(SimTime stamp) const;
  void Publish(const Moment& moment);
  bool SomebodyAsks() const;

  const RobotWorld& physics_;
  double speed_;
  const int period_substeps_;
  // empty if another sim publishes it
  std::optional<bus::Publisher<rosgraph_msgs::msg::Clock>> clock_;
  std::vector<std::unique_ptr<Robot>> robots_;
  std::optional<bus::Publisher<tf2_msgs::msg::TFMessage>> fleet_;
  std::optional<bus::Publisher<tf2_msgs::msg::TFMessage>> fleet_fixed_;
  SimTime step_begin_;
  Clock::TimePoint wall_begin_{};
  bool is_dense_ = false;       // this step
  std::deque<Moment> waiting_;  // oldest first
};

}  // namespace conav::sim
