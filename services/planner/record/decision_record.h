#pragma once

#include <vector>

#include "common/grid/grid.h"
#include "common/protocol/search_report.h"

namespace conav::planner {

/// A decision and the situation that it was made in. All cells lie in the robot's map; the
/// operator's has its shape.
struct DecisionRecord {
  /// Empty tree and views unless planner.search.report asked for them. A decision that was made
  /// without a search has no nodes, and the action taken as its only one.
  SearchReport report;
  OccupancyGrid map;  // the robot's
  BeliefGrid belief;  // the operator's, as published; empty = decided without having heard of it
  std::vector<Cell> goals_left;
  std::vector<Cell> path;      // since the last picture, the present cell last
  std::vector<Cell> guidance;  // empty without
  std::vector<Cell> plan;      // cells that the robot meant to enter, nearest first
  /// Kind, target and heading of what was commanded; kDrive = an order of whoever steers the robot.
  SearchAction taken;
  bool operator==(const DecisionRecord&) const = default;

  bool has_search() const { return report.nodes > 0; }
  bool sends_picture() const { return taken.kind == CommandKind::kTransmitView; }
};

}  // namespace conav::planner
