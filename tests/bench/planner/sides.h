#pragma once

#include <fmt/core.h>
#include <malloc.h>

#include <algorithm>
#include <map>
#include <memory>
#include <vector>

#include "bench/support/bench_program.h"
#include "common/grid/geometry.h"
#include "common/runtime/random.h"
#include "nhpm/model/perception_network.h"
#include "planner/methods/ig_mcts_method.h"
#include "planner/perception/cached_model.h"
#include "sim/world/map_corruption.h"
#include "sim/world/random_maze.h"
#include "study/experiment/search_experiment.h"

namespace conav::bench {

/// A random maze of side x side cells with as many rooms for its area as the usual one of 13 x 13,
/// a robot that starts in its middle, and the usual number of goals anywhere. Mazes have odd sides:
/// an even one has a second wall in the south and the east.
inline sim::WorldSpec MazeOfSide(int side, std::uint64_t seed) {
  sim::RandomMazeOptions options;
  options.height = options.width = side - (side + 1) % 2;
  options.max_rooms = std::max(1, 6 * side * side / (13 * 13));
  options.retry_count *= options.max_rooms;
  const sim::Maze maze = sim::GenerateMaze(options, seed, 1);
  sim::WorldSpec world;
  world.truth = OccupancyGrid(side, side, Occupancy::kOccupied);
  std::vector<Cell> free;
  for (std::size_t i = 0; i < maze.entities.size(); ++i) {
    const Cell cell = maze.entities.CellAt(i);
    if (maze.entities[cell] == sim::kMazeWall) continue;
    world.truth[cell] = Occupancy::kFree;
    free.push_back(cell);
  }
  const auto off_middle = [&](Cell cell) {
    return std::abs(2 * cell.row - side) + std::abs(2 * cell.column - side);
  };
  world.starts = {*std::ranges::min_element(free, {}, off_middle)};
  std::erase(free, world.starts.front());
  Random random(seed);
  random.Shuffle(free);
  world.goals = {{free.begin(), free.begin() + 4}};
  std::set<Cell> kept(free.begin(), free.begin() + 4);
  kept.insert(world.starts.front());
  world.human_map = sim::CorruptMap(world.truth, kept, {}, seed).value();
  return world;
}

/// What decisions in mazes of one side cost.
struct SideCost {
  std::vector<double> ms;     // of each decision, processor time
  double step_ms = 0.0;       // of a step of the episode: decision, simulated operator and maze
  double memory_mib = 0.0;    // that method, cache and network hold at the end of an episode
  double whole_passes = 0.0;  // of the network, in the episode with the most
};

/// The side that larger ones are compared to.
inline constexpr int kComparedSide = 26;

/// The first `decisions` decisions of an episode of the default method in each of `mazes` mazes.
inline SideCost MeasureSide(int side, int mazes, int decisions, const nhpm::NetworkModel& model) {
  SideCost cost;
  const auto held = [] {
    const struct mallinfo2 info = mallinfo2();
    return static_cast<double>(info.uordblks + info.hblkhd) / (1 << 20);
  };
  const SteadyClock clock;
  const operators::SyntheticOperatorParameters person;
  const planner::EpisodeOptions limit{.action_limit = decisions};
  double seconds = 0.0;
  for (int i = 1; i <= mazes; ++i) {
    const auto seed = static_cast<std::uint64_t>(i);
    const sim::WorldSpec world = MazeOfSide(side, seed);
    const double before = held();
    const auto network = std::make_shared<nhpm::PerceptionNetwork>(model);
    const auto cache = std::make_shared<planner::CachedPerceptionModel>(network);
    planner::IgMctsMethod method({}, seed, cache, clock);
    seconds += ThreadSecondsOf([&] {
      const auto result = planner::RunEpisode(world, method, person, seed, limit);
      cost.ms.insert(cost.ms.end(), result.decision_ms.begin(), result.decision_ms.end());
    });
    cost.memory_mib = std::max(cost.memory_mib, held() - before);
    const auto whole_passes = static_cast<double>(network->whole_passes());
    cost.whole_passes = std::max(cost.whole_passes, whole_passes);
  }
  cost.step_ms = 1e3 * seconds / static_cast<double>(cost.ms.size());
  return cost;
}

/// Measures each side in each round; rounds are medians. Metrics side<N>_..., and p95_ratio: of the
/// largest side to kComparedSide, if that is among them and smaller.
inline Rounds MeasureSides(const BenchProgram& program, const std::vector<int>& sides, int mazes,
                           int decisions, const nhpm::NetworkModel& model) {
  Rounds rounds;
  program.ForEachRound([&] {
    std::map<int, double> p95_ms;
    for (const int side : sides) {
      const SideCost cost = MeasureSide(side, mazes, decisions, model);
      const std::string name = fmt::format("side{}_", side);
      p95_ms[side] = Quantile(cost.ms, 0.95);
      rounds.Add({{name + "p50_ms", Quantile(cost.ms, 0.5)},
                  {name + "p95_ms", p95_ms[side]},
                  {name + "longest_ms", Quantile(cost.ms, 1.0)},
                  {name + "step_ms", cost.step_ms},
                  {name + "whole_passes", cost.whole_passes},
                  {name + "memory_mib", cost.memory_mib}});
    }
    const auto [largest, largest_ms] = *p95_ms.rbegin();
    const auto compared = p95_ms.find(kComparedSide);
    if (compared != p95_ms.end() && largest > kComparedSide) {
      rounds.Add({{"p95_ratio", largest_ms / compared->second}});
    }
  });
  return rounds;
}

/// A table line for each side, then the ratio with its bar.
inline void PrintSides(const Rounds& rounds, const std::vector<int>& sides) {
  fmt::print("{:>9} {:>9} {:>9} {:>9} {:>16} {:>13} {:>12}\n", "side", "p50 ms", "p95 ms",
             "longest", "episode step ms", "whole passes", "memory MiB");
  for (const int side : sides) {
    const auto value = [&](const char* rest) {
      return rounds.Median(fmt::format("side{}_{}", side, rest));
    };
    fmt::print("{:>9} {:9.2f} {:9.2f} {:9.2f} {:16.2f} {:13.0f} {:12.1f}\n", side, value("p50_ms"),
               value("p95_ms"), value("longest_ms"), value("step_ms"), value("whole_passes"),
               value("memory_mib"));
  }
  fmt::print("\nwhole passes of the network: of the episode with the most\n");
  if (rounds.Of("p95_ratio").empty()) return;
  fmt::print("p95 at {} over p95 at {}: {:.2f} (bar: 1.5)\n", std::ranges::max(sides),
             kComparedSide, rounds.Median("p95_ratio"));
}

}  // namespace conav::bench
