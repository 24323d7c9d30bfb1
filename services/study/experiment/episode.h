#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "common/grid/map_accuracy.h"
#include "common/runtime/clock.h"
#include "operator/simulated/synthetic_operator.h"
#include "planner/decision/method.h"
#include "sim/world/world_spec.h"

namespace conav::planner {

/// One robot, one SIMULATED operator and one maze in one process and one thread: the decisions, the
/// operator and the maze are those of the services, bus, physics and camera are left out. For
/// experiments with the search over many mazes, and for benchmarks; a study runs the services.
struct EpisodeOptions {
  double range_cells = 2.0;  // what the robot sees around it
  /// Moves and pictures after which an episode counts as failed.
  int action_limit = 600;
};

struct EpisodeResult {
  bool all_goals = false;
  int goals_reached = 0;
  int goals = 0;
  int moves = 0;             // cells entered
  double turning_rad = 0.0;  // of the robot on the spot, for moves and views
  int optimal_moves = 0;     // shortest tour over all goals on the true map
  int blocked = 0;           // moves into cells that turned out to be walls
  int pictures = 0;
  int guidance = 0;
  int edits = 0;                    // cells, by the operator
  double mapping_accuracy = 0.0;    // MapAccuracy::mapping at the end
  std::vector<double> decision_ms;  // processor time
  std::uint64_t perception_queries = 0;
  std::uint64_t perception_cached = 0;
  std::vector<Cell> trajectory;  // cells entered
};

/// Low-level control steps (0.25 s) that the simulator's robot takes for so many cells and so much
/// turning on the spot. Fitted to 24 episodes of the greedy robot over real physics: 0.7 steps of
/// 296 off in the root mean square (docs/methods.md).
double EstimatedLowLevelSteps(double moves, double turning_rad);

/// Sees each situation in which a decision is made.
using SituationListener = std::function<void(const Situation&)>;

/// Robot 0 of `world` until its goals are reached or nothing more happens. The operator answers
/// each picture before the next decision. Deterministic for a method and an operator that are.
EpisodeResult RunEpisode(const sim::WorldSpec& world, Method& method,
                         const operators::SyntheticOperatorParameters& person, std::uint64_t seed,
                         const EpisodeOptions& options = {},
                         const SituationListener& listener = nullptr);

/// Steps of the shortest tour from the start of robot 0 over all its goals on the true map.
int OptimalMoves(const sim::WorldSpec& world);

}  // namespace conav::planner
