#pragma once

#include <functional>
#include <optional>
#include <string>
#include <utility>

#include "common/msg/robot.h"
#include "common/runtime/clock.h"
#include "robot/driver/alignment.h"

namespace conav::robot {

/// Where to drive: to within `tolerance_m` of `place`, then turn to `heading_rad`.
struct Target {
  Position place;
  double tolerance_m = 0.1;
  std::optional<double> heading_rad;
  bool last = true;  // the robot stands there; else it drives on to the next one
};

/// A way to move a robot. Places are those of the operator's plan. Threads: one caller.
class Mover {
 public:
  enum class State : std::uint8_t { kDriving, kArrived, kFailed };
  struct Progress {
    State state = State::kDriving;
    std::string reason;  // why it failed
  };

  /// Says why it cannot move now, for people; empty if it can.
  using Missing = std::function<std::string()>;

  explicit Mover(Missing missing) : missing_(std::move(missing)) {}
  virtual ~Mover() = default;
  /// Replaces the target before.
  virtual void Begin(const Target& target, const Pose& at) = 0;
  /// Call at about 20 Hz from Begin() on.
  virtual Progress Step(const Pose& at, Clock::TimePoint now) = 0;
  /// Stands. `at` is the newest place, which may be out of date.
  virtual void Cancel(const Pose& at) = 0;
  /// Call at about 20 Hz while it stands.
  virtual void Rest() {}
  /// Goes on with this low-level action until Cancel(); false if this way cannot.
  virtual bool Drive(DriveAction) { return false; }
  std::string Problem() const { return missing_ ? missing_() : ""; }

 private:
  Missing missing_;
};

struct Velocity {
  double forward_mps = 0.0;
  double turn_rps = 0.0;
  bool operator==(const Velocity&) const = default;
};

struct PursuitOptions {
  double speed_mps = 0.3;
  double turn_rps = 0.8;
  double acceleration_mps2 = 0.5;
  double heading_tolerance_rad = 0.05;
};

/// Drives by velocities: turns towards the place where it looks elsewhere, drives there, slower as it comes
/// near, and turns to the heading. Stops in front of nothing by itself: the driver watches the way.
class PursuitMover final : public Mover {
 public:
  using Send = std::function<void(const Velocity&)>;
  PursuitMover(const PursuitOptions& options, Send send, Missing missing = nullptr)
      : Mover(std::move(missing)), options_(options), send_(std::move(send)) {}

  void Begin(const Target& target, const Pose& at) override;
  Progress Step(const Pose& at, Clock::TimePoint now) override;
  void Cancel(const Pose& at) override;
  void Rest() override;
  bool Drive(DriveAction action) override;

 private:
  double TurnBy(double error_rad) const;
  void Publish(Velocity velocity);

  PursuitOptions options_;
  Send send_;
  Target target_;
  bool is_there_ = false;  // at the place; it only turns
  Velocity velocity_;
  std::optional<Clock::TimePoint> stepped_at_;
  int rests_ = 0;  // zeros sent since it stands
};

/// Sends whole goals to a follower that says nothing of them, as RViz does on /goal_pose. The robot has
/// arrived when it is there and, at its last place, stands.
class GoalPoseMover final : public Mover {
 public:
  using Send = std::function<void(const Pose&)>;
  GoalPoseMover(double heading_tolerance_rad, Send send, Missing missing = nullptr)
      : Mover(std::move(missing)),
        heading_tolerance_rad_(heading_tolerance_rad),
        send_(std::move(send)) {}

  void Begin(const Target& target, const Pose& at) override;
  Progress Step(const Pose& at, Clock::TimePoint now) override;
  /// A goal where it stands: such a follower knows no cancelling.
  void Cancel(const Pose& at) override { send_(at); }

 private:
  bool Stands(const Pose& at, Clock::TimePoint now);

  double heading_tolerance_rad_;
  Send send_;
  Target target_;
  std::optional<Pose> stood_at_;
  Clock::TimePoint stood_since_{};
};

/// Whether the robot has arrived at the target; with a heading to within `heading_tolerance_rad`.
bool IsAt(const Target& target, const Pose& at, double heading_tolerance_rad);
/// What a follower of whole goals is sent: without a heading it ends as it came.
Pose GoalOf(const Target& target, const Pose& at);

}  // namespace conav::robot
