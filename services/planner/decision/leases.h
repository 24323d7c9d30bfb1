#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "common/msg/planner_lease.h"
#include "common/runtime/clock.h"
#include "common/runtime/result.h"

// One user: the service; pure, and tested without the bus.

namespace conav::planner {

/// One live planner process that shares robots.
struct Member {
  std::string instance;
  std::set<std::string> robots;  // that it is configured for
  std::set<std::string> holds;   // a part of these; no robot is held by two
};

/// The assignment of robots to members: robot -> instance.
///
/// A robot stays with the member that holds it where that is fair; the others go to the member with
/// the fewest. Then robots move as long as one move makes two members more equal, the last in order
/// of names first. So members with the same robots differ by one at most, and as few robots as
/// possible move. The result does not depend on the order of `members`: processes that know the
/// same compute the same, and their single steps lead there, too.
std::map<std::string, std::string> AssignRobots(std::vector<Member> members);

/// Decides which robots this planner process holds, from what the processes announce and from the
/// lease epochs that the robots show. There is no broker: each process computes the same assignment
/// (AssignRobots) from the announcements that it receives.
///
/// - A robot is taken with an epoch above all that it showed: when nobody has ever commanded
///   it, when its holder released it, or when its holder has been silent, and the robot without a
///   new command of a foreign epoch, for `timeout`.
/// - A robot assigned to another process is released: Turn() says so once, and it counts as held
///   until Released() reports that its command has ended.
/// - A robot is lost when it shows a higher epoch than ours, or when a live process announces one
///   (with the same epoch the higher instance wins). A process that lost a robot does
///   not fight for it: it gets robots again as any newcomer does, from those that hold more.
/// - After a pause of its own (a suspended process) it gives the others `timeout` to
///   report before it counts them as gone.
///
/// Time is wall time and comes with each call. Threads: one caller.
class LeaseTable {
 public:
  using TimePoint = Clock::TimePoint;

  struct Options {
    std::string node;
    std::string instance;
    std::vector<std::string> robots;
    std::chrono::nanoseconds period = std::chrono::milliseconds(250);
    std::chrono::nanoseconds timeout = std::chrono::seconds(2);
    /// Processes that are waited for, at most `timeout`, before the first robot is taken.
    int planners = 1;
  };

  struct Changes {
    struct Grant {
      std::string robot;
      std::uint64_t lease_epoch = 0;
    };
    std::vector<Grant> taken;
    std::vector<std::string> to_release;
    std::vector<std::string> lost;
    std::vector<std::string> planners_gone;  // nodes that fell silent
  };

  LeaseTable(Options options, TimePoint now);

  /// What another process announced; its own echo is ignored. Errors: kRefused, a lease epoch more
  /// than kMaxCounterStep ahead, which the robot would not take.
  [[nodiscard]] Result<void> Receive(const PlannerLease& lease, TimePoint now);
  /// What a robot's state shows; robots that are not ours to drive are ignored.
  void Receive(const std::string& robot, std::uint64_t lease_epoch,
               std::uint64_t command_sequence_number, TimePoint now);
  /// The worker has ended the robot's last command and sends none after it.
  void Released(const std::string& robot);

  /// What has to be done now. Call often: the age of others is counted only while it is called.
  Changes Turn(TimePoint now);

  /// What to tell the others, when it has changed or a period has passed. `load` is left to the
  /// caller.
  std::optional<PlannerLease> Announcement(TimePoint now);
  /// The last one: everything is given up.
  PlannerLease Farewell();

  /// Node that is known to drive the robot; empty = none.
  std::string DriverOf(const std::string& robot) const;
  /// 0 = not held.
  std::uint64_t EpochOf(const std::string& robot) const;
  int live_planners() const { return 1 + static_cast<int>(others_.size()); }

 private:
  struct Other {
    PlannerLease lease;
    TimePoint received_at;
  };
  struct Robot {
    std::uint64_t epoch = 0;  // ours; 0 = not held
    bool releasing = false;
    bool has_reported = false;
    std::uint64_t shown_epoch = 0;  // by its newest state
    std::uint64_t shown_sequence_number = 0;
    TimePoint foreign_command;         // when it last showed a new command that was not ours
    std::uint64_t highest_epoch = 0;   // shown, announced or ours
    std::uint64_t released_epoch = 0;  // highest that its holder gave up by itself
  };

  /// Who holds a robot: the highest epoch, then the highest instance.
  using Holders = std::map<std::string, std::pair<std::uint64_t, std::string>>;

  void ForgiveAfterPause(TimePoint now);
  void ForgetSilent(TimePoint now, Changes& changes);
  void GiveUpLost(Changes& changes);
  bool StillGathering(TimePoint now);
  void Rebalance(TimePoint now, Changes& changes);
  bool MayTake(const Robot& robot, TimePoint now) const;
  Holders FindHolders() const;
  std::vector<Member> Members(const Holders& holders) const;
  PlannerLease Ours() const;

  Options options_;
  TimePoint started_;
  TimePoint last_turn_;
  std::map<std::string, Robot> robots_;
  std::map<std::string, Other> others_;  // by instance
  bool gathered_ = false;  // those that were expected have come, or were waited for long enough
  bool changed_ = true;    // a message came that Turn() has to look at
  TimePoint looked_at_{};
  std::optional<PlannerLease> announced_;
  TimePoint announced_at_{};
};

}  // namespace conav::planner
