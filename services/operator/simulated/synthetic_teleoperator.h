#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "common/grid/grid.h"
#include "common/msg/robot.h"
#include "common/msg/supervision.h"
#include "common/runtime/clock.h"
#include "common/runtime/random.h"
#include "operator/simulated/steering.h"
#include "operator/simulated/synthetic_operator.h"

namespace conav::operators {

/// A robot to be driven somewhere for the sake of another one.
struct DriveTask {
  std::string robot;
  Cell cell;
  int keys_left = 80;  // then it is given up
  bool operator==(const DriveTask&) const = default;
};

/// Where robots stand, for the question who makes room.
struct Meeting {
  const BeliefGrid& map;        // with what was seen
  const std::set<Cell>& walls;  // known for certain
  std::string robot;            // that has to pass
  Cell cell;
  std::vector<Cell> path;  // that it wants, from its cell on
  std::string blocker;     // stands on the path
  Cell blocker_cell;
  std::set<Cell> others;  // cells of all other robots
};

/// What to drive where so that `robot` can pass `blocker`, in order: the blocker off the path; or,
/// where `robot` shuts it in, first `robot` off the blocker's way out. Empty when neither is
/// possible on cells that the map shows free.
std::vector<DriveTask> MakeRoom(const Meeting& meeting);

/// One SYNTHETIC person who steers robots by keys, one robot at a time, four keys per second.
///
/// Knows: the operator's map, which may be wrong; where it shows the robots; what the streamed
/// pictures show, where noticed (StreamMemory); what a robot bumped into. Does not know the
/// truth. Plans over the goals on the map with what was seen, keeps to the way by keys (steering.h)
/// after a reaction time, now and then presses a wrong key or holds one too long, and now and then
/// corrects the map. Steers the first robot with goals left until it has none; where another robot
/// stands in the way, drives that one aside first.
///
/// The next key is chosen when the last one was carried out and its picture is here, so that with a
/// simulator that runs as fast as it is commanded everything is the same for a seed; with several
/// robots in a world, when their states arrive in one order. After a pause (wall time) a key
/// that was refused is pressed again, the same one where nothing has changed since (a service that
/// has not received the robot's state yet, for example); one that is not carried out is chosen
/// again. One request is under way at a time: after Next() gave one, Answered() must follow. Pure;
/// threads: not synchronised. Source: paper section 6.2.
class SyntheticTeleoperator {
 public:
  SyntheticTeleoperator(const SyntheticOperatorParameters& parameters, std::uint64_t seed,
                        const std::map<std::string, std::string>& world_of_robot);

  /// Messages of robots and worlds that are not this person's are ignored.
  void Receive(const Belief& belief);
  void ReceiveCellSize(const std::string& world, double cell_size_m);
  void Receive(const RobotState& state);
  void Receive(const Snapshot& snapshot);

  std::optional<OperatorAsk> Next(Clock::TimePoint now);
  void Answered(const Result<OperatorReply>& reply, Clock::TimePoint now);

  struct Counts {
    std::uint64_t keys = 0;      // passed on
    std::uint64_t bumps = 0;     // into walls
    std::uint64_t meetings = 0;  // with robots in the way
    std::uint64_t edits = 0;     // cells, accepted
    std::uint64_t refused = 0;   // requests
    std::string newest_problem;
  };
  const Counts& counts() const { return counts_; }
  /// Robots with goals left.
  std::size_t open() const;

 private:
  struct Robot {
    std::string world;
    std::optional<RobotState> state;
    std::uint64_t newest_snapshot = 0;  // sequence number
    std::deque<Snapshot> unseen;        // received, not looked at
    std::uint64_t order = 0;            // newest that was passed on; 0 = none of ours
    Clock::TimePoint ordered_at{};
    std::uint64_t judged_order = 0;  // whose outcome was looked at
    std::deque<ShownPose> poses;     // before each of the keys of the reaction time, oldest first
    std::deque<DriveAction> keys;    // pressed since
    DriveAction last_key = DriveAction::kStop;
    bool to_centre = false;  // after a bump
    bool finished() const { return !state || state->goals_left.empty(); }
  };
  struct World {
    std::optional<Belief> belief;
    double cell_size_m = 0.0;
    std::uint64_t revision_needed = 0;  // of our own newest edit
    std::optional<StreamMemory> seen;
  };

  Robot* Find(const std::string& robot, const std::string& world);
  World& WorldOf(const Robot& robot) { return worlds_.at(robot.world); }
  GridGeometry GeometryOf(const Robot& robot) const;

  // choosing whom to steer
  bool KnowsAll() const;
  std::optional<OperatorAsk> AskFor(const std::string& name, Clock::TimePoint now);
  std::string Choose();
  bool Ready(const Robot& robot, Clock::TimePoint now) const;
  void Judge(const std::string& name, Robot& robot);
  void SendForRoom(const std::string& name, const Robot& robot);
  void SendAnywhere(const Robot& robot);
  /// Another robot stands on cell `blocked` of `path`. False when nothing can be done about it.
  bool AskForRoom(const std::string& name, const Robot& robot, const std::vector<Cell>& path,
                  Cell blocked);
  bool Arrived(const DriveTask& task) const;

  // looking, planning, pressing
  void Look(Robot& robot);
  std::optional<OperatorAsk> MaybeEdit(const Robot& robot);
  ShownPose PoseNow(const Robot& robot) const;
  Cell CellNow(const Robot& robot, const std::set<Cell>& walls) const;
  std::vector<Cell> PathFor(const std::string& name, Robot& robot);
  std::vector<Cell> PlanPath(const Robot& robot, Cell start, const std::set<Cell>& obstacles,
                             const std::vector<Cell>& goals) const;
  std::set<Cell> CellsOfOthers(const std::string& name, const std::string& world) const;
  /// The refused key, if the robot is where it was.
  std::optional<OperatorAsk> Again();
  DriveAction Press(Robot& robot, DriveAction meant);
  OperatorAsk Order(const std::string& name, Robot& robot, DriveAction key, Clock::TimePoint now);
  void Refresh(Robot& robot);

  SyntheticOperatorParameters parameters_;
  Random random_;
  std::map<std::string, Robot> robots_;
  std::map<std::string, World> worlds_;
  std::deque<DriveTask> tasks_;  // to be done before going on
  int tasks_in_a_row_ = 0;       // since a goal was reached
  std::size_t goals_left_ = 0;
  std::string steered_;
  std::optional<OperatorAsk> under_way_;
  std::optional<OperatorAsk> refused_;  // the newest key, if it was
  Clock::TimePoint not_before_{};
  Counts counts_;
};

}  // namespace conav::operators
