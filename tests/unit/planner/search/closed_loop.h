#pragma once

#include <cstdint>
#include <vector>

#include "common/grid/grid.h"
#include "common/runtime/random.h"
#include "planner/search/ig_mcts.h"

/// A whole episode in a grid world, in process: robot, operator and planner take turns. For tests
/// of the planner; the real parts are put together in tests/system.
namespace conav::planner::closed_loop {

struct World {
  OccupancyGrid truth;
  BeliefGrid belief;  // the operator's map at the start, partly wrong
  Cell start;
  std::vector<Cell> goals;
};

/// A random maze of `size` x `size` cells, odd, with rooms and loops; four goals; `wrong_cells`
/// cells of the operator's map flipped, never on the border, the start or a goal.
World MakeWorld(std::uint64_t seed, int size = 15, int wrong_cells = 20);

/// The operator's path through all goals left: cheapest tour on their own map, where entering a
/// wall costs 10 more (docs/paper.md).
/// Only the part through the first `goal_limit` goals is drawn.
std::vector<Cell> DrawGuidance(const BeliefGrid& belief, Cell from, const std::vector<Cell>& goals,
                               int goal_limit);

struct EpisodeOptions {
  double range_cells = 2.0;
  int headings = 8;
  int action_limit = 600;
  int guidance_goals = 1'000;     // how many goals ahead the operator draws
  double edit_probability = 0.6;  // of a seen discrepancy, falling with exp(-decay * distance)
  double edit_decay = 0.15;
  double path_edit_probability = 0.9;  // of a wall on the robot's path
};

struct EpisodeResult {
  bool all_goals = false;
  int moves = 0;
  int blocked = 0;
  int messages = 0;
  int decisions = 0;
  std::uint64_t perception_calls = 0;
  std::uint64_t perception_queries = 0;
  int edits = 0;
  std::vector<double> decision_ms;
  std::vector<Cell> trajectory;  // cells entered, for comparing runs
};

EpisodeResult RunEpisode(const World& world, const SearchOptions& search, PerceptionModel& model,
                         std::uint64_t seed, const EpisodeOptions& options = {});

}  // namespace conav::planner::closed_loop
