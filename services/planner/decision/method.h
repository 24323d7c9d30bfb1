#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "common/grid/visibility.h"
#include "common/msg/planning.h"
#include "common/msg/robot.h"
#include "common/msg/supervision.h"
#include "common/runtime/clock.h"
#include "common/runtime/threads.h"
#include "planner/decision/blackboard.h"
#include "planner/search/reward.h"

namespace conav::planner {

/// Everything that one decision may depend on. Complete by the time a method sees it.
struct Situation {
  RobotState state;
  MapUpdate map;
  Belief belief;
  CameraLens lens;
  std::optional<Guidance>
      guidance;  // absent when there is none, it was withdrawn, or it has expired
  std::optional<DriveOrder> drive;      // newest order of who steers the robot, carried out or not
  SimTime now;                          // newest simulation time received from the robot's world
  std::uint64_t answered_snapshot = 0;  // newest picture that the operator answered
  std::uint64_t answered_belief = 0;    // revision of the map at that answer
  std::optional<OccupancyGrid> truth;   // in the mapping task only
  bool guided_before = false;           // the operator has given this robot a path at some time
  std::vector<Neighbour> neighbours;
  std::uint32_t goals_to_find = 0;  // somebody else has to find them (GoalKnowledge::kTold)
  bool sends_no_pictures = false;   // it refused to a moment ago: its camera is silent
  bool lacks_way = false;           // knows neither a goal nor a way to one, but the operator does
};

/// The robot's next action; `kind` is a move, a view or a low-level action.
struct Action {
  CommandKind kind = CommandKind::kMove;
  Cell target;
  double heading_rad = 0.0;
  DriveAction drive = DriveAction::kStop;
  std::uint64_t drive_order = 0;  // drive: DriveOrder::sequence_number
  SimTime expires_at;             // drive: that of its order; others expire after command_ttl
  std::vector<Cell> route;        // move: places to drive along, `target` last; empty = that alone
};

struct Decision {
  std::optional<Action> action;  // absent = wait
  /// Without an action: when to decide again although nothing has changed on which it depends;
  /// min() = soon.
  Clock::TimePoint again = Clock::TimePoint::max();
  /// Set to ask for the operator; then, without an action, the robot waits for a newer guidance.
  std::optional<AttentionReason> attention;
  Cell attention_cell;
  double expected_information = 0.0;
  /// How much more the search expects of asking than of going on, reward units, at least 0.
  double answer_value = 0.0;
  std::vector<Cell>
      plan;             // cells that the robot means to enter, nearest first; for people to look at
  SearchReport report;  // actions, chosen, counts, model; the worker fills in the rest
};

/// The move along `plan`, decided without a search; `plan` is not empty.
Decision MoveAlong(std::vector<Cell> plan);

/// What a robot knows of its goals.
enum class GoalKnowledge {
  kAll,   // where they are
  kSeen,  // those in cells that it has seen, and those on the operator's path
  kTold,  // those in its state, and that there are more: somebody else finds them
};
inline constexpr std::array kGoalKnowledges{GoalKnowledge::kAll, GoalKnowledge::kSeen,
                                            GoalKnowledge::kTold};
constexpr std::string_view Name(GoalKnowledge knowledge) {
  return knowledge == GoalKnowledge::kAll    ? "all"
         : knowledge == GoalKnowledge::kSeen ? "seen"
                                             : "told";
}

/// Leaves in `situation` what a robot with such knowledge goes by. Its goals become those that it drives
/// to: while it knows of none but has goals, the end of the operator's path if it knows of no wall on
/// that, else the nearest cell that it has not seen (frontier-based exploration: Yamauchi, CIRA 1997).
/// A path whose end it has seen, without a goal there, guides no longer. Under kSeen the operator knows
/// the goals: a robot that is left with unseen cells lacks a way that an answer would bring.
void LimitKnowledge(Situation& situation, GoalKnowledge knowledge);

/// Turns a route (places in the map frame; RViz "2D Goal Pose" has one) into guidance. To one place: the
/// shortest path from the robot's cell, over cells that neither the robot knows as walls nor, where
/// the robot knows nothing, the operator takes for walls. Along several: the cells on the straight
/// lines between them, from the robot's own on. Valid for ten minutes of simulation time; it keeps
/// the revision of `current`, so that the operator's next path replaces it, and answers the robot's
/// newest picture. Errors: kOutOfRange (a place outside of the map), kNotFound (no path).
Result<Guidance> GuidanceAlong(const std::vector<Position>& places, const RobotState& state,
                               const MapUpdate& map, const Belief& belief,
                               const std::optional<Guidance>& current);

/// What a robot's decisions wait for from its operator; each includes those before it.
enum class AwaitedInput {
  kNothing,   // decides whether there is an operator or not
  kBelief,    // the operator's map
  kGuidance,  // and a first path, and the map that the newest path was drawn on
  kAnswers,   // and an answer to each picture, which so needs the camera's lens
};

/// One way of supervising a robot: IG-MCTS, instruction following, teleoperation; or none. One
/// object per robot. Threads: one worker's.
class Method {
 public:
  virtual ~Method() = default;
  /// Ends early, with what it has, when `stop` asks for it.
  virtual Decision Decide(const Situation& situation, const StopToken& stop) = 0;
  /// The robot's map while it carries out a command: what can be worked out before the next decision.
  virtual void Prepare(const OccupancyGrid& /*map*/) {}
  /// Cells that the robot would enter next if no other robot were there; robots without the right
  /// of way make room on them.
  virtual std::vector<Cell> IntendedPathFor(const Situation& situation) = 0;
  /// The same throughout; below kGuidance the operator's paths are not followed.
  virtual AwaitedInput awaits() const = 0;
  /// Somebody steers the robot by low-level actions: it makes room for nobody by itself.
  virtual bool is_steered() const { return false; }
};

/// What a robot loses for each second of simulation time that the operator does not answer, in
/// reward units per second, so that an attention queue can compare robots and methods:
///
///   standing    V - (r_step + gamma V) = (1 - gamma) V - r_step per decision period: the return of
///               its work now, less that of the same work one period later. V is the discounted
///               return (appendix C: r_g at a goal, r_step else) of the tour to its goals, always
///               to the nearest one left, over all that is not known to be a wall. The search's
///               own values are not taken for it: rollouts at random hardly reach a goal, and the
///               methods without a search have none.
///   staleness   log n per decision period, the guidance term of appendix C, while the robot is off
///               the operator's path.
///   answer      what the search expects of the answer beyond going on, Q(view) - Q(best move), if
///               positive, spread over the time after which the robot goes on without; it is lost
///               once, not with each period. None for a robot that waits for ever.
///
/// A decision period is the time of a move from cell to cell.
struct ValueLostOptions {
  RewardOptions reward;
  double discount = 0.99;       // gamma
  double answer_timeout_s = 0;  // 0 = the robot waits for ever
};

double ValueLostPerSecond(const Situation& situation, double answer_value,
                          const ValueLostOptions& options);

/// Discounted return of the tour that ValueLostPerSecond() speaks of; 0 when no goal can be
/// reached.
double TourReturn(const Situation& situation, const ValueLostOptions& options);

/// Mean time of the robot's moves so far, with turns and pictures; 2.5 s before its first.
double DecisionPeriodSeconds(const RobotState& state);

/// Q(chosen) - Q(best move) of a search's root, at least 0; 0 without a visited move.
double AnswerValue(std::span<const SearchAction> actions, const SearchAction& chosen);

}  // namespace conav::planner
