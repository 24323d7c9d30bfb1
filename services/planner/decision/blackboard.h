#pragma once

#include <condition_variable>
#include <cstdint>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/grid/visibility.h"
#include "common/msg/planner_lease.h"
#include "common/msg/planning.h"
#include "common/msg/robot.h"
#include "common/msg/supervision.h"
#include "common/runtime/clock.h"
#include "common/runtime/result.h"

namespace conav::planner {

/// Whether this planner process may command a robot.
struct Lease {
  enum class State {
    kNone,       // another process drives it, or nobody yet
    kHeld,       // this process drives it
    kReleasing,  // to be given up when its last command has ended
  };
  State state = State::kHeld;
  std::uint64_t epoch = 0;  // for its commands; 0 = one above the robot's
  bool operator==(const Lease&) const = default;
};

/// Where a ROS 2 program or tool sends a robot that keeps its goals: to one place, by a way that the
/// planner finds (goal_pose, NavigateToPose), or along places (FollowPath). It becomes guidance, and its
/// end comes before the robot's own goals.
struct Route {
  std::uint64_t number = 0;         // given by the blackboard
  std::vector<Position> positions;  // one = go there
  bool operator==(const Route&) const = default;
};

/// What became of a robot's newest route.
struct RouteStatus {
  enum class Stage {
    kWaits,     // the robot does not decide yet
    kTaken,     // it is the robot's guidance, and its end the robot's only goal
    kReached,   // its end; the robot goes on to its own goals
    kRefused,   // for `reason`
    kReplaced,  // by the operator's path
  };
  std::uint64_t number = 0;  // 0 = there was none
  Stage stage = Stage::kWaits;
  std::string reason;
  Cell end{};  // of the guidance; once taken
};

/// The newest of everything that the planner has received about one robot.
struct RobotInputs {
  Lease lease;  // held, where nobody shares robots
  std::optional<RobotState> state;
  std::optional<MapUpdate> map;
  std::optional<Belief> belief;         // of the robot's world
  std::optional<Guidance> guidance;     // newest revision, or what a route was turned into
  std::optional<StopOrder> stop_order;  // the operator's; the robot's own state confirms it
  std::optional<DriveOrder> drive;      // newest low-level action asked for, carried out or not
  std::optional<Route> route;           // not yet turned into guidance
  RouteStatus route_status;             // of the newest one
  std::optional<CameraLens> lens;       // of its camera
  std::optional<OccupancyGrid> truth;   // of the robot's world; in the mapping task only
  std::string
      misaligned;  // another robot of its world whose map has another geometry; empty = none
  /// Rises with each change on which a decision of the robot may depend: of its own inputs, and of the
  /// robots next to it and to its way. The time alone is none.
  std::uint64_t causes = 0;

  bool stopped() const { return (stop_order && stop_order->stopped) || (state && state->stopped); }
};

/// The next moves of another robot of the same world; they decide which robot gives way.
struct Neighbour {
  std::string robot;
  Cell cell;
  bool has_goals = false;
  std::vector<Cell> path;                       // cells that it wants to enter next, nearest first
  RoomClaim room;                               // by which it makes room for another
  bool is_driving = false;                      // carries out a command
  std::optional<Cell> entering = std::nullopt;  // the cell next to its own that it drives into
};

/// The receiving thread puts messages here and the robots' workers read them. A change wakes the
/// workers that it concerns: the robot's own, and those of robots that stand near it and may have to
/// give way, which a robot that carries out a command does not.
/// Threads: safe to use concurrently.
class Blackboard {
 public:
  /// `world_of_robot`: every robot of this planner with the name of its world.
  explicit Blackboard(std::map<std::string, std::string> world_of_robot);

  void Put(RobotState state);
  void PutMap(const std::string& robot, MapUpdate map);
  void Put(const Belief& belief);
  void Put(Guidance guidance);
  void Put(DriveOrder order);
  void Put(StopOrder order);
  /// The true map of a world.
  void PutTruth(const std::string& world, const OccupancyGrid& truth);
  void PutLens(const std::string& robot, const CameraLens& lens);
  /// Replaces the robot's earlier route. Returns its number.
  std::uint64_t PutRoute(const std::string& robot, std::vector<Position> positions);
  /// A robot's worker puts its intended path here for the other workers, and the reason why it does
  /// not decide for the operator's side. A changed path wakes those near it; a reason wakes nobody.
  /// True when the path changed.
  bool PutIntendedPath(const std::string& robot, std::vector<Cell> path, RoomClaim room = {});
  void PutBlockedReason(const std::string& robot, std::string_view reason);
  std::string_view BlockedReasonOf(const std::string& robot) const;
  void PutLease(const std::string& robot, Lease lease);
  Lease LeaseOf(const std::string& robot) const;
  /// The worker no longer sends commands under `lease`; nothing happens when that has changed.
  void GiveUp(const std::string& robot, Lease lease);
  /// Requests for attention are numbered on from the newest that any planner process sent.
  void ReceivedAttention(const std::string& robot, std::uint64_t sequence_number);
  std::uint64_t NextAttention(const std::string& robot);
  /// The worker has turned route `number` into guidance, or could not. Nothing happens when a newer
  /// route or the operator's own path came in the meantime.
  void ResolveRoute(const std::string& robot, std::uint64_t number, Result<Guidance> guidance);
  /// The robot stands at the end of the route that is its guidance: it guides no longer.
  void FinishRoute(const std::string& robot);
  /// The robot no longer follows that route: its guidance is withdrawn, where it still is that.
  void CancelRoute(const std::string& robot, std::uint64_t number);
  RouteStatus RouteStatusOf(const std::string& robot) const;

  RobotInputs Read(const std::string& robot) const;
  /// Other robots of the same world, in order of their names.
  std::vector<Neighbour> NeighboursOf(const std::string& robot) const;
  /// Newest simulation time received from the robot's world.
  SimTime NewestStamp(const std::string& robot) const;

  /// Rises with every change that concerns the robot.
  std::uint64_t version(const std::string& robot) const;
  /// Blocks until version() differs from `seen` or `deadline` passed; returns the version.
  std::uint64_t WaitForChange(const std::string& robot, std::uint64_t seen,
                              Clock::TimePoint deadline) const;
  /// Wakes all waiting workers, for example to stop.
  void Touch();

 private:
  struct Entry {
    std::string world;
    RobotInputs inputs;
    std::vector<Cell> path;
    RoomClaim room;
    std::uint64_t attentions = 0;
    std::string_view blocked_reason = "its state";  // a literal, of Name()
    std::uint64_t version = 0;
    mutable std::condition_variable changed;
  };
  /// What other robots see of one.
  struct Presence;

  Entry* FindLocked(const std::string& robot);
  /// Nothing happens to a robot that is not this planner's.
  template <class Apply>
  void Change(const std::string& robot, Apply&& apply);
  static Presence PresenceOf(const Entry& entry);
  static void ChangedLocked(Entry& entry, bool is_cause = true);
  /// Wakes the workers that the change of `entry` since `before` concerns.
  void ChangedForOthersLocked(const Entry& entry, const Presence& before);

  mutable std::mutex mutex_;  // guards all below
  std::map<std::string, Entry> robots_;
};

}  // namespace conav::planner
