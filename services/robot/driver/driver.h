#pragma once

#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/msg/robot.h"
#include "common/msg/supervision.h"
#include "common/runtime/clock.h"
#include "robot/command_gate.h"
#include "robot/driver/map_keeper.h"
#include "robot/driver/mover.h"
#include "robot/driver/view.h"

// One user: the service; why it is apart: it is what the robot does, without the bus.

namespace conav::robot {

struct DriverOptions {
  std::string world;
  std::string robot;
  MapKeeper::Options map;
  ViewOptions view;
  double clearance_m = 0.3;     // kept free between two robots, besides their radii
  double wait_s = 4.0;          // for another robot on the way, before that ends the command
  double stuck_s = 10.0;        // without progress for so long the way is blocked
  double blocked_for_s = 60.0;  // a way that did not work is a wall for so long
  double retry_s = 2.0;         // after a mover's failure, until the next goal
  double map_timeout_s = 15.0;  // 0 = a map published once is enough
  double picture_timeout_s = 5.0;
  double picture_settle_s = 0.3;  // a picture counts from so long after the turn
  /// Of the camera's joint, counter-clockwise from straight ahead; both 0 = the camera is fixed.
  double pan_least_rad = 0.0;
  double pan_most_rad = 0.0;
  double pan_settle_s = 1.5;
};

/// A robot that speaks ROS 2, as the contract of docs/robots.md wants a robot: what it carries out and
/// what it reports, without bus and motors.
///
/// It stands, whatever the command in force, while something that it needs is missing, and goes on with
/// the command when it is back, until the command expires; `command_detail` says meanwhile why it
/// stands. Threads: one caller.
class Driver {
 public:
  using Pan = std::function<void(double angle_rad)>;
  Driver(const DriverOptions& options, std::unique_ptr<Mover> mover, Pan pan = nullptr);

  // What came in. Places are those of the operator's plan.
  void SetGrid(const GridGeometry& grid);
  bool has_grid() const { return keeper_.has_value(); }
  /// Requires has_grid().
  void Receive(RobotMap map, Clock::TimePoint now);
  void Receive(const CameraLens& lens) { lens_ = lens; }
  /// `problem`: why the place cannot be trusted; empty if it can.
  void Locate(const std::optional<Pose>& place, const std::string& problem, double speed_mps,
              double turn_rps);
  void SetHeldByOthers(std::vector<Position> places) { gate_.SetHeldByOthers(std::move(places)); }
  Result<void> Receive(const RobotCommand& command, SimTime now);
  void Receive(const StopOrder& order);
  /// From when on a picture counts for the view that is under way, if one is.
  std::optional<Clock::TimePoint> picture_wanted_since() const { return picture_since_; }
  /// Requires picture_wanted_since().
  void Receive(Picture picture, const DepthProfile& depth, SimTime now);

  /// Call at about 20 Hz.
  void Step(SimTime now, Clock::TimePoint wall);

  /// Only the lease epoch and the stop are kept over a restart.
  void Restore(const RobotState& before) { gate_.Restore(before); }
  RobotState latched() const {
    RobotState state;
    gate_.Report(state);
    return state;
  }

  /// Before the program ends.
  void Stand() {
    if (place_ && gate_.active()) mover_->Cancel(*place_);
  }

  // What goes out, in this order.
  std::optional<MapUpdate> TakeMap();
  std::optional<Snapshot> TakeSnapshot();
  /// Nothing before it has a place on a map.
  std::optional<RobotState> state() const;
  bool active() const { return gate_.active(); }
  /// Why it stands, or would; for people; empty = it can move.
  std::string Problem() const;

 private:
  void BeginCommand();
  void BeginLeg();
  void BeginView();
  void DriveLeg();
  void StepDrive();
  void AwaitPicture();
  void Hold();
  bool IsWayOpen();
  bool IsStuck();
  void Finish(CommandOutcome outcome, std::string detail = {});
  void NoteCell();
  void RefreshMap();
  std::string CameraProblem() const;

  enum class Phase : std::uint8_t { kIdle, kDrive, kTurn, kPicture };

  DriverOptions options_;
  std::unique_ptr<Mover> mover_;
  Pan pan_;
  CommandGate gate_;
  std::optional<MapKeeper> keeper_;
  std::optional<CameraLens> lens_;
  std::optional<Pose> place_;
  std::string location_problem_ = "localisation: no place yet";
  std::optional<Clock::TimePoint> map_received_;
  RobotState state_;
  SimTime now_;
  Clock::TimePoint wall_{};

  Phase phase_ = Phase::kIdle;
  std::optional<Clock::TimePoint> waits_since_;  // another robot is on the way
  std::optional<Position> held_at_;              // a problem interrupts the command in force: where
  std::deque<Target> targets_;
  Clock::TimePoint not_before_{};
  Clock::TimePoint phase_began_{};
  double least_left_ = 0.0;  // of the way, a mixture of metres and radians
  Clock::TimePoint progress_at_{};
  double pan_rad_ = 0.0;
  std::optional<Clock::TimePoint> picture_since_;

  std::optional<MapUpdate> map_;  // the newest
  bool map_changed_ = false;      // since TakeMap()
  bool map_stale_ = false;        // may differ from what is known
  std::optional<Snapshot> snapshot_;
};

/// The robot's time after `elapsed`, from `now`: it follows the time of day, which may be set, without a
/// step back and without one that ends all commands. Half or twice as fast it closes a gap; a gap ahead of
/// more than a minute, as of a computer without a battery, it jumps.
SimTime FollowTimeOfDay(SimTime now, SimTime time_of_day, std::chrono::nanoseconds elapsed);

}  // namespace conav::robot
