#pragma once

#include <filesystem>
#include <functional>
#include <vector>

#include "common/grid/grid.h"
#include "common/msg/search_report.h"
#include "common/runtime/result.h"
#include "common/segments/segment_log.h"

namespace conav::decisions {
class Decision;
class Record;
}  // namespace conav::decisions

namespace conav::planner {

/// A decision and the situation that it was made in. All cells lie in the robot's map; the
/// operator's has its shape.
struct DecisionRecord {
  /// Empty tree and views unless planner.search.report asked for them. A decision that was made
  /// without a search has no nodes, and the action taken as its only one.
  SearchReport report;
  OccupancyGrid map;  // the robot's
  BeliefGrid belief;  // the operator's, as published; empty = decided before it was received
  std::vector<Cell> goals_left;
  std::vector<Cell> path;      // since the last picture, the present cell last
  std::vector<Cell> guidance;  // empty without
  std::vector<Cell> plan;      // cells that the robot meant to enter, nearest first
  /// Kind, target and heading of what was commanded; kDrive = an order of the steering client.
  SearchAction taken;
  bool operator==(const DecisionRecord&) const = default;

  bool has_search() const { return report.nodes > 0; }
  bool sends_snapshot() const { return taken.kind == CommandKind::kTransmitView; }
};

// Between decisions and the records of idl/decisions.proto, which go no further.

inline constexpr std::uint32_t kDecisionSchemaVersion = 1;

decisions::Record HeaderRecord();
/// Cells outside of the map are left out of goals, path, guidance and plan.
decisions::Record ToRecord(const DecisionRecord& decision);

/// Errors: kMalformed names what no decision can have: a map's size or value, a cell, a parent in
/// the tree, a probability, columns of different lengths.
[[nodiscard]] Result<DecisionRecord> FromRecord(const decisions::Decision& record);

/// Reads what DecisionLog wrote and calls `take` with each decision, in the order of the file, also
/// while it grows. True when it ends inside of a decision, as it does when the planner was killed:
/// all before that are taken.
/// Errors, with path and the decision's place: kNotFound; kIo; kMalformed (empty, no zstd, damaged,
/// something else, another schema version).
[[nodiscard]] Result<bool> ReadDecisions(const std::filesystem::path& path,
                                         const std::function<void(DecisionRecord&&)>& take);

/// A file of decisions (idl/decisions.proto) that grows while a planner runs: a FrameLog, each
/// decision a frame of its own. A decision takes about 2 kB, several with a whole tree.
class DecisionLog {
 public:
  /// Goes on after what the file has. Errors: as FrameLog::Open(); kMalformed also for a file of
  /// something else.
  [[nodiscard]] static Result<DecisionLog> Open(const std::filesystem::path& path);

  /// Errors: kIo; then the file is as it was.
  [[nodiscard]] Result<void> Append(const DecisionRecord& decision);

 private:
  explicit DecisionLog(FrameLog log) : log_(std::move(log)) {}

  FrameLog log_;
};

}  // namespace conav::planner
