#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/runtime/clock.h"
#include "common/runtime/random.h"
#include "operator/simulated/synthetic_operator.h"
#include "planner/decision/method.h"
#include "sim/world/world_spec.h"

/// Robots and one SIMULATED operator in one process and one thread: what decides, moves aside and
/// answers is that of the services; bus, physics and camera are left out. For experiments over many
/// worlds, for benchmarks, and for the Python package; a study runs the services.
namespace conav::planner {

struct EpisodeOptions {
  double range_cells = 2.0;  // what a robot sees around itself
  /// Moves and pictures of a robot, on average, after which an episode counts as failed.
  int action_limit = 600;
  /// Goals are objects that only a person recognises: neither knows of one until a picture shows it
  /// and the person marks it; then the robot may reach it.
  bool marked_goals = false;
  /// The person watches a stream of pictures, one for each low-level step.
  bool streams = false;
};

struct EpisodeResult {
  bool all_goals = false;
  int goals_reached = 0;
  int goals = 0;
  int moves = 0;             // cells entered
  double turning_rad = 0.0;  // of the robots on the spot, for moves and views
  int optimal_moves = 0;     // shortest tours over all goals on the true map
  int blocked = 0;           // moves into cells that turned out to be walls, or taken
  int snapshots = 0;
  int guidance = 0;
  int edits = 0;                    // cells, by the operator
  double mapping_accuracy = 0.0;    // MapAccuracy::mapping at the end
  double time_s = 0.0;              // simulated, until the last action ended
  int action_limit = 0;             // of all robots together
  std::vector<double> decision_ms;  // processor time
  std::uint64_t perception_queries = 0;
  std::uint64_t perception_cached = 0;
  std::vector<Cell> trajectory;  // cells entered, by all robots in turn
};

/// Low-level control steps (0.25 s) that the simulator's robot takes for so many cells and so much
/// turning on the spot. Fitted to 24 episodes of the greedy robot over real physics: 0.7 steps of
/// 296 off in the root mean square (docs/tradeoff.md).
double EstimatedLowLevelSteps(double moves, double turning_rad);

/// Steps of the shortest tours from the starts of all robots over all their goals on the true map.
int OptimalMoves(const sim::WorldSpec& world);

/// The robots, the true map and the operator of one episode, with actions from outside. Simulated
/// time passes by the actions' EstimatedLowLevelSteps(). The operator answers at once.
/// Deterministic. Threads: one caller.
class CellWorld {
 public:
  /// `world` outlives it.
  CellWorld(const sim::WorldSpec& world, const operators::SyntheticOperatorParameters& person,
            std::uint64_t seed, EpisodeOptions options);

  int robot_count() const { return static_cast<int>(robots_.size()); }
  SimTime now() const { return now_; }
  const std::string& world_name() const { return belief_.world; }
  const RobotState& state(int robot) const { return At(robot).state; }
  const MapUpdate& map(int robot) const { return At(robot).map; }
  const Belief& belief() const { return belief_; }
  const OccupancyGrid& truth() const { return truth_; }
  /// The operator's newest path.
  const std::optional<Guidance>& guidance(int robot) const { return At(robot).guidance; }
  /// The newest picture, if any.
  const std::optional<Snapshot>& picture(int robot) const { return At(robot).picture; }
  bool is_done() const;  // all goals are reached

  /// Whether `robot` carries out an action.
  bool is_busy(int robot) const { return At(robot).until.has_value(); }
  /// Begins a move to a neighbouring cell, or the picture of a view. A move into a wall or towards
  /// another robot ends at once, and the robot has seen the wall. Requires that it is not busy.
  void Begin(int robot, const Action& action);
  /// Lets the operator answer `request`.
  void Ask(const AttentionRequest& request);
  /// Time passes until the next action ends, at most until `latest`.
  void Advance(SimTime latest);

  /// All but the decisions.
  EpisodeResult Result() const;

 private:
  struct Robot {
    RobotState state;  // goals_left: what may be known of
    MapUpdate map;
    std::optional<Guidance> guidance{};
    std::optional<Snapshot> picture{};
    std::vector<Cell> unmarked{};  // goals that nobody has recognised
    Action action{};
    std::optional<SimTime> until{};  // of the action
  };

  Robot& At(int robot) { return robots_[static_cast<std::size_t>(robot)]; }
  const Robot& At(int robot) const { return robots_[static_cast<std::size_t>(robot)]; }
  int Find(const std::string& name) const;
  bool IsHeld(Cell cell, int by_other_than) const;
  double TurnTo(Robot& robot, double heading_rad);
  void Start(Robot& robot, double moves, double turning_rad);
  void End(int robot);
  void Refuse(int robot, CommandOutcome outcome, Cell cell);
  void Look(Robot& robot);
  void ClaimGoal(Robot& robot);
  void Send(Robot& robot);
  void Stream(Robot& robot, int steps);
  void Mark(Robot& robot, const Snapshot& snapshot);
  Snapshot MakeSnapshot(Robot& robot) const;
  void CloseDoors();
  void LetThePersonAct();
  std::uint64_t Edit(const EditRequest& request);
  std::uint64_t Guide(const GuideRequest& request);

  const sim::WorldSpec& spec_;
  EpisodeOptions options_;
  OccupancyGrid truth_;
  std::vector<sim::Door> open_doors_;  // one waits while a robot is in its cell or on the way there
  Belief belief_;
  CameraLens lens_;
  std::vector<Robot> robots_;
  SimTime now_;
  FakeClock clock_;  // the person's: nobody waits here
  operators::SyntheticOperatorParameters parameters_;
  operators::SyntheticOperator person_;
  Random noticing_;
  EpisodeResult result_;
};

/// Sees each situation in which a decision is made.
using SituationListener = std::function<void(const Situation&)>;

/// How a planner drives the robots of an episode: as conav-planner does, by RobotWorkers on one
/// blackboard, with `clock` for their waits.
struct EpisodeDriver {
  std::vector<Method*> methods;  // one per robot; they outlive the episode
  FakeClock& clock;              // also that of methods without a time budget
  GoalKnowledge goal_knowledge = GoalKnowledge::kAll;
  SituationListener listener = nullptr;
};

/// Until all goals are reached or nothing more happens. Deterministic for methods and an operator
/// that are.
EpisodeResult RunEpisode(const sim::WorldSpec& world, const EpisodeDriver& driver,
                         const operators::SyntheticOperatorParameters& person, std::uint64_t seed,
                         const EpisodeOptions& options = {});

/// The same for robot 0 alone, with any clock in `method`.
EpisodeResult RunEpisode(const sim::WorldSpec& world, Method& method,
                         const operators::SyntheticOperatorParameters& person, std::uint64_t seed,
                         const EpisodeOptions& options = {},
                         const SituationListener& listener = nullptr);

}  // namespace conav::planner
