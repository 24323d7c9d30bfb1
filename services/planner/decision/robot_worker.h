#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "common/msg/robot.h"
#include "common/msg/supervision.h"
#include "common/runtime/clock.h"
#include "common/runtime/random.h"
#include "common/runtime/result.h"
#include "common/runtime/threads.h"
#include "planner/decision/blackboard.h"
#include "planner/decision/method.h"

namespace conav::planner {

/// What is wrong with inputs that are well-formed one by one but do not belong together, for
/// example an operator's map of another building. The text names both sides and their values;
/// nothing when all fits. Needs state and map; the rest is looked at where it is there.
std::optional<std::string> Inconsistency(const RobotInputs& inputs);

/// Why a robot does not decide right now.
enum class BlockedReason {
  kNothing,        // decide
  kState,          // its first state has not arrived
  kCommand,        // its last command is still being executed
  kStopped,        // a person has stopped it
  kMap,            // the map of its newest step has not arrived
  kCamera,         // its camera's lens
  kBelief,         // the operator's map, at the revision that the guidance was drawn on
  kInconsistent,   // map, state, belief and guidance do not belong together (Inconsistency)
  kFirstGuidance,  // soft: the operator has not drawn a path yet
  kAnswer,         // soft: the operator has not answered the newest picture
  kNoLease,        // another planner process drives it, or none yet
  kLeaseLost,      // it shows the command of another planner that took it over
  kRelease,        // it has ended its last command, and this process gives it up
};

/// What the robot waits for, in words; lives for ever.
std::string_view Name(BlockedReason reason);

/// Decides when a robot has everything that its next decision needs, so that the same messages give
/// the same decisions in any order of arrival. Soft reasons end after a timeout: the robot goes on
/// alone. Threads: one worker's.
class DecisionGate {
 public:
  /// Of the soft reasons; by the clock whose time Check() gets.
  struct Timeouts {
    std::chrono::nanoseconds first_guidance;
    std::chrono::nanoseconds answer;
  };

  DecisionGate(AwaitedInput awaits, Timeouts timeouts) : awaits_(awaits), timeouts_(timeouts) {}

  /// `sent_sequence_number` and `lease_epoch` are those of the worker's last command.
  BlockedReason Check(const RobotInputs& inputs, std::uint64_t sent_sequence_number,
                      std::uint64_t lease_epoch, Clock::TimePoint now);

  /// True once after a soft reason ended by its timeout.
  bool TakeTimedOut() { return std::exchange(timed_out_, false); }

 private:
  BlockedReason ReasonNow(const RobotInputs& inputs, std::uint64_t sent_sequence_number,
                          std::uint64_t lease_epoch) const;

  AwaitedInput awaits_;
  Timeouts timeouts_;
  BlockedReason blocked_ =
      BlockedReason::kState;  // ignores kCommand: a step aside does not restart the wait
  Clock::TimePoint blocked_since_{};
  bool without_guidance_ = false;          // stopped waiting for the first guidance
  std::uint64_t unanswered_snapshot_ = 0;  // stopped waiting for an answer to this one
  bool timed_out_ = false;
};

/// Random waits of a robot that keeps making room, so that robots which step to and fro for each
/// other fall out of step: after the k-th time without getting on, 0 to 2^k - 2 slots, k at most 4.
/// The first time it waits for nothing. Getting on is kOwnMoves moves of its own in a row.
///
/// Binary exponential back-off: Metcalfe and Boggs, "Ethernet: Distributed Packet Switching for
/// Local Computer Networks", CACM 1976.
class YieldBackoff {
 public:
  static constexpr int kOwnMoves = 4;

  explicit YieldBackoff(std::uint64_t seed) : random_(seed) {}

  /// The robot steps aside. `slot`: wall time.
  void MakesRoom(Clock::TimePoint now, std::chrono::nanoseconds slot) {
    own_moves_ = 0;
    times_ = times_ < kMostTimes ? times_ + 1 : kMostTimes;
    until_ = now + random_.Uniform(0, (std::int64_t{1} << times_) - 2) * slot;
  }
  /// It goes on its own way.
  void Moves() {
    if (++own_moves_ >= kOwnMoves) times_ = 0;
  }
  /// When it may go on its own way again.
  Clock::TimePoint until() const { return until_; }

 private:
  static constexpr int kMostTimes = 4;

  Random random_;
  Clock::TimePoint until_{};
  int times_ = 0;
  int own_moves_ = 0;
};

/// Writes a robot's commands: sequence numbers, lease epoch, expiry, and the repeat of a command
/// that the robot has not taken up. Threads: one worker's.
class CommandPublisher {
 public:
  CommandPublisher(std::string robot, std::chrono::nanoseconds ttl)
      : robot_(std::move(robot)), ttl_(ttl) {}

  /// Starts again under a lease; epoch 0 = one above the robot's, taken with the first command.
  void Begin(std::uint64_t lease_epoch);

  /// The next command. Its number follows the robot's, which another program may have moved on, unless
  /// that is near the end of the range.
  RobotCommand Issue(const Action& action, const RobotState& state, SimTime now);

  /// Whether the robot took up the last command. Another planner's may have its number, but not its
  /// epoch.
  bool IsShownBy(const RobotState& state) const;

  /// The last command, when the robot shows an older one or one of another lease; with a fresh expiry
  /// unless it is a low-level action, which nobody wants late.
  std::optional<RobotCommand> Repeat(const RobotState& state, SimTime now);

  /// 0 before the first command.
  std::uint64_t sent_sequence_number() const { return last_.sequence_number; }
  std::uint64_t lease_epoch() const { return last_.lease_epoch; }

 private:
  std::string robot_;
  std::chrono::nanoseconds ttl_;
  RobotCommand last_;
};

/// Drives one robot: waits until its next decision has everything it needs, decides, sends, and
/// waits for the outcome. Run() is the body of the robot's thread; Step() is one turn of it, for
/// tests.
///
/// With every method a robot moves aside for a robot with the right of way (traffic.h), also while
/// it waits for guidance or an answer; unless a person steers it.
///
/// Sends commands only while the blackboard says that this process drives the robot (Lease), each
/// under the epoch of that lease; before it gives the robot up it ends the last command. What a
/// worker remembers of a robot that others drove meanwhile does no harm: docs/many-robots.md.
///
/// A robot that decided to wait decides again when something changes on which that depends
/// (RobotInputs::causes), at the time that the method named, and after 5 s in any case.
///
/// Decides nothing for a robot that a person has stopped, until the order is to resume and the robot
/// confirms it; the robot itself ends its command (robot/command_gate.h).
///
/// Sends nothing before the first state arrives. Withdraws its request to the operator when it goes
/// on without an answer. Stale input: it ignores expired or withdrawn guidance; it waits once per
/// picture for an operator who does not answer, then goes on alone (one log line). Inputs that do
/// not belong together (Inconsistency()) block the robot, with one log line. Logs commands that were
/// refused or expired.
class RobotWorker {
 public:
  /// What the worker sends; all are called on the worker's thread.
  struct Outputs {
    std::function<void(const RobotCommand&)> command;
    std::function<void(const SearchReport&)> report;
    std::function<void(const AttentionRequest&)> attention;
    /// The decision's plan, for people to look at.
    std::function<void(const RobotState&, const MapUpdate&, const std::vector<Cell>&)> plan;
    /// The robot's intended path when it changed, for the planners of other robots; may be null.
    std::function<void(const IntendedPath&)> intended_path = nullptr;
    /// After the command of a decision was sent; its report is complete. May be null.
    std::function<void(const Decision&, const Situation&)> decided = nullptr;
    /// After each decision, also one to wait or to step aside, with the method's wall time in ms. May be
    /// null.
    std::function<void(double)> timed = nullptr;
  };

  struct Options {
    std::string robot;
    std::string method_name;
    DecisionGate::Timeouts timeouts;
    std::chrono::nanoseconds command_ttl;  // simulation time; low-level actions have their own
    /// Of random waits; another one for each robot.
    std::uint64_t seed = 0;
    /// Whether `timeouts` are simulation time; else they are wall time.
    bool timeouts_in_simulation_time = false;
    /// Of attention requests; its answer_timeout_s is that of `timeouts`.
    ValueLostOptions value_lost{};
    GoalKnowledge goal_knowledge = GoalKnowledge::kAll;
  };

  RobotWorker(Options options, std::unique_ptr<Method> method, Blackboard& board,
              const Clock& clock, Outputs outputs);

  /// Until `stop`; Blackboard::Touch() wakes it.
  void Run(const StopToken& stop);

  /// Decides if possible. Returns when to look again if nothing changes before. `stop` ends a
  /// decision early.
  Clock::TimePoint Step(const StopToken& stop);

 private:
  /// Whether `inputs` allow a decision, else why not; logs and reports a change.
  BlockedReason CheckInputs(const RobotInputs& inputs, Clock::TimePoint now);
  /// The time that the gate counts by, when it is `now` by the clock.
  Clock::TimePoint GateTime(Clock::TimePoint now) const;
  /// Returns when to look again, as Step() does.
  Clock::TimePoint Decide(const Situation& situation, const Lease& lease, const StopToken& stop,
                          Clock::TimePoint now);
  /// For a robot that decided to wait: its right of way may come with time.
  Clock::TimePoint LookAgain(Clock::TimePoint now) const;
  void AdoptLease(const Lease& lease);
  /// Whether the lease that the decision was begun under still holds.
  bool StillHolds(const Lease& lease) const;
  /// Puts the intended path on the board and publishes it to other processes if it changed; always
  /// the first time under a lease, because late joiners receive it from this process only.
  void SetIntendedPath(std::vector<Cell> path, RoomClaim room);
  /// What the robot does while it is blocked; returns when to look again.
  Clock::TimePoint WaitFor(BlockedReason reason, const RobotInputs& inputs, Clock::TimePoint now);
  /// One log line where a person should know why the robot does not decide.
  void ReportBlocked(BlockedReason reason, const RobotInputs& inputs) const;
  void ReportOutcome(const RobotState& state);
  enum class Traffic { kGoOn, kStepAside, kWait };
  /// Publishes this robot's intended path, and makes room for a robot with the right of way.
  Traffic GiveWay(const Situation& situation, const std::vector<Cell>& own_path);
  /// Whether the last command met another robot, the first time that this is asked of it. A method
  /// that does not know of that robot would command the same again and again.
  bool IsNewlyOccupied(const RobotState& state);
  void RepeatCommand(const RobotInputs& inputs, Clock::TimePoint now);
  /// Turns a route into guidance, or logs why not.
  void AdoptRoute(RobotInputs& inputs);
  /// One log line for a route that waits until a person lets the robot go on.
  void ReportWaitingRoute(const RobotInputs& inputs, BlockedReason reason);
  Situation SituationFrom(const RobotInputs& inputs);
  void Publish(Decision decision, const Situation& situation, double duration_ms);
  /// To the operator, numbered; of the robot as it is now.
  AttentionRequest NextRequest(const RobotState& state);
  void Ask(const Decision& decision, const Situation& situation);
  /// Adds how long the robot waits and what that costs, and sends it.
  void Ask(AttentionRequest request, double answer_value, const Situation& situation);
  /// For a robot that waits for an answer to its newest picture: at once what this worker has not asked
  /// under this lease, else now and then.
  void AskAgain(const Situation& situation, Clock::TimePoint now);
  /// Its earlier question no longer needs an answer.
  void WithdrawRequest(const RobotState& state);

  Options options_;
  std::unique_ptr<Method> method_;
  Blackboard& board_;
  const Clock& clock_;
  Outputs outputs_;
  DecisionGate gate_;
  CommandPublisher commands_;
  YieldBackoff backoff_;
  BlockedReason blocked_ = BlockedReason::kState;
  Clock::TimePoint command_sent_at_{};
  /// Wall time that its last command took: what robots need to get out of each other's way.
  std::chrono::nanoseconds pace_{0};
  bool is_shut_in_ = false;
  Clock::TimePoint shut_in_at_{};               // when it last was
  Clock::TimePoint shut_in_since_{};            // but for short gaps
  std::uint64_t reported_sequence_number_ = 0;  // of the command whose outcome was looked at
  std::uint64_t view_sequence_number_ = 0;      // of the newest command to send a picture
  SimTime pictures_again_at_;                   // it refused that
  std::uint64_t occupied_sequence_number_ = 0;  // of the newest command that met another robot
  std::uint64_t lease_epoch_ = 0;
  std::uint64_t waiting_route_ = 0;           // of which a line was logged
  std::uint64_t newest_revision_ = 0;         // of the guidance received, valid or not
  std::uint64_t waiting_for_other_than_ = 0;  // revision of the guidance when it asked for another
  std::uint64_t waited_at_ = 0;               // RobotInputs::causes of the last decision
  Clock::TimePoint decide_again_{};           // without another cause; passed if it acted
  std::optional<AttentionRequest> question_;  // the newest under this lease
  Clock::TimePoint asked_at_{};
  bool intended_path_published_ = false;  // under this lease
  bool waiting_for_guidance_ = false;
  bool guided_before_ = false;
};

}  // namespace conav::planner
