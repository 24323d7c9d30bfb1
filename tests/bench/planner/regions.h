#pragma once

#include <fmt/core.h>

#include <memory>
#include <optional>
#include <stdexcept>
#include <vector>

#include "bench/support/bench_program.h"
#include "common/grid/visibility.h"
#include "planner/navigation/region_graph.h"
#include "sim/world/clearance.h"
#include "sim/world/terrain.h"

namespace conav::bench {

/// What the navigation graph of open terrain costs, in ms of processor time.
struct RegionCosts {
  std::vector<double> update_ms;  // for each cell of the drive in which the robot saw more
  std::vector<double> build_ms;   // the same map from nothing, now and then
};

inline constexpr std::size_t kMostUpdates = 300;  // of one drive
inline constexpr std::size_t kUpdatesPerBuild = 25;

/// A robot that drives through a waterway, into its dead end and then to the goal, and sees the
/// paper's 50 cells around itself. The waterway is one of side x side cells, of which each is drawn as
/// scale x scale.
class RegionDrive {
 public:
  RegionDrive(int side, int scale) : truth_(side * scale, side * scale) {
    const sim::Terrain terrain = sim::MakeTerrain({.rows = side, .columns = side}, 1).value();
    for (std::size_t i = 0; i < truth_.size(); ++i) {
      const Cell cell = truth_.CellAt(i);
      truth_.values()[i] = terrain.truth[{cell.row / scale, cell.column / scale}];
    }
    const Grid<std::uint8_t> room = sim::RoomFor(terrain.truth, 0.5);
    AddWay(sim::WayBack(sim::StepsFrom(room, terrain.dead_end), terrain.start), scale);
    AddWay(sim::WayBack(sim::StepsFrom(room, terrain.goal), terrain.dead_end), scale);
  }

  /// Ends after kMostUpdates. Throws when a graph built whole has another number of vertices.
  RegionCosts Measure() const {
    RegionCosts costs;
    OccupancyGrid known(truth_.rows(), truth_.columns(), Occupancy::kUnknown);
    std::optional<planner::RegionGraph> graph;
    for (const Cell cell : way_) {
      if (costs.update_ms.size() == kMostUpdates) break;
      const OccupancyGrid before = known;
      const VisibleCells seen = CastRange(truth_, cell, sim::kGreedyRangeCells);
      for (const Cell free : seen.free) known[free] = Occupancy::kFree;
      for (const Cell land : seen.walls) known[land] = Occupancy::kOccupied;
      if (known == before) continue;
      if (!graph) {
        Build(known, graph);
        continue;
      }
      costs.update_ms.push_back(1e3 * ThreadSecondsOf([&] { graph->Update(known); }));
      if (costs.update_ms.size() % kUpdatesPerBuild != 1) continue;
      std::optional<planner::RegionGraph> built;
      costs.build_ms.push_back(Build(known, built));
      if (built->vertex_count() != graph->vertex_count()) {
        throw std::runtime_error("an updated graph has other vertices than one built whole");
      }
    }
    return costs;
  }

 private:
  /// From cell to cell, each as `scale` steps.
  void AddWay(const std::vector<Cell>& way, int scale) {
    for (std::size_t i = 1; i < way.size(); ++i) {
      const Cell step = way[i] - way[i - 1];
      const Cell from{way[i - 1].row * scale + scale / 2, way[i - 1].column * scale + scale / 2};
      for (int k = 0; k < scale; ++k) way_.push_back(from + Cell{k * step.row, k * step.column});
    }
  }
  /// In ms.
  static double Build(const OccupancyGrid& known, std::optional<planner::RegionGraph>& graph) {
    const auto views =
        std::make_shared<const planner::GridViews>(planner::GridViews::Options{.lens = {}});
    return 1e3 * ThreadSecondsOf([&] {
             graph.emplace(planner::RegionOptions{}, views);
             graph->Update(known);
           });
  }

  OccupancyGrid truth_;
  std::vector<Cell> way_;
};

/// "region_build_ms" and so on.
inline void AddRegionCosts(const RegionCosts& costs, const std::string& prefix, Rounds& rounds) {
  const double build_ms = Median(costs.build_ms), update_ms = Median(costs.update_ms);
  rounds.Add({{prefix + "_build_ms", build_ms},
              {prefix + "_update_p50_ms", update_ms},
              {prefix + "_update_p95_ms", Quantile(costs.update_ms, 0.95)},
              {prefix + "_build_ratio", build_ms / update_ms}});
}

inline void PrintRegionCosts(const Rounds& rounds) {
  fmt::print("\n{:<34} {:>8} {:>8} {:>8} {:>10}\n", "graph of a waterway's regions, ms", "update",
             "p95", "built", "built over");
  fmt::print("{:<34} {:>8} {:>8} {:>8} {:>10}\n", "", "p50", "", "whole", "update");
  for (const auto& [name, prefix] :
       {std::pair{"150 x 150 (bar: 5)", "region"}, {"1000 x 1000", "region1000"}}) {
    const auto value = [&](const char* rest) {
      return rounds.Median(fmt::format("{}_{}", prefix, rest));
    };
    fmt::print("{:<34} {:8.2f} {:8.2f} {:8.2f} {:10.1f}\n", name, value("update_p50_ms"),
               value("update_p95_ms"), value("build_ms"), value("build_ratio"));
  }
}

}  // namespace conav::bench
