#include "operator/belief/belief_rules.h"

#include <fmt/format.h>

#include <set>

namespace conav::operators {
namespace {

std::string MapSize(const BeliefGrid& map) {
  return fmt::format("the map of {} x {} cells", map.rows(), map.columns());
}

Result<void> CheckEditedCells(const BeliefGrid& map, const std::vector<CellEdit>& edits) {
  std::set<Cell> cells;
  for (const CellEdit& edit : edits) {
    if (!map.Contains(edit.cell)) {
      return Fail(ErrorCode::kRefused,
                  fmt::format("cell {} lies outside of {}", edit.cell, MapSize(map)));
    }
    if (map.OnBorder(edit.cell)) {
      return Fail(ErrorCode::kRefused,
                  fmt::format("cell {} is on the border of {}, which cannot be edited", edit.cell,
                              MapSize(map)));
    }
    if (!cells.insert(edit.cell).second) {
      return Fail(ErrorCode::kRefused,
                  fmt::format("cell {} is edited twice in one request", edit.cell));
    }
  }
  return {};
}

Result<void> CheckPath(const BeliefGrid& map, const std::vector<Cell>& path, int limit) {
  if (path.size() > static_cast<std::size_t>(limit)) {
    return Fail(ErrorCode::kRefused,
                fmt::format("the path has {} cells; the limit is {}", path.size(), limit));
  }
  for (std::size_t i = 0; i < path.size(); ++i) {
    if (!map.Contains(path[i])) {
      return Fail(ErrorCode::kRefused, fmt::format("path cell {} (index {}) lies outside of {}",
                                                   path[i], i, MapSize(map)));
    }
    if (i > 0 && !AreNeighbours(path[i - 1], path[i])) {
      return Fail(ErrorCode::kRefused,
                  fmt::format("path cells {} and {} (index {}) are not 4-neighbours", path[i - 1],
                              path[i], i));
    }
  }
  return {};
}

}  // namespace

Result<Belief> ApplyEdit(const Belief& current, const EditRequest& request,
                         const std::string& client, SimTime now) {
  if (request.edits.empty()) return Fail(ErrorCode::kRefused, "the edit names no cell");
  if (request.base_revision != current.revision) {
    return Fail(ErrorCode::kRefused,
                fmt::format("the edit is based on revision {} of world {}; the current one is {}",
                            request.base_revision, current.world, current.revision));
  }
  if (auto checked = CheckEditedCells(current.wall_probability, request.edits); !checked) {
    return tl::unexpected(checked.error());
  }
  Belief edited = current;
  for (const CellEdit& edit : request.edits) {
    edited.wall_probability[edit.cell] = edit.wall ? 1.0F : 0.0F;
  }
  edited.stamp = now;
  edited.revision = current.revision + 1;
  edited.edited_by = client;
  return edited;
}

Result<Guidance> MakeGuidance(const Belief& belief, const GuideRequest& request,
                              std::uint64_t last_revision, const std::string& client, SimTime now,
                              const GuidanceLimits& limits) {
  if (!(request.valid_for_s > 0.0 && request.valid_for_s <= limits.valid_for_s)) {
    return Fail(ErrorCode::kRefused, fmt::format("valid_for = {} s is not in (0, {}]",
                                                 request.valid_for_s, limits.valid_for_s));
  }
  if (auto checked = CheckPath(belief.wall_probability, request.path, limits.path_cells);
      !checked) {
    return tl::unexpected(checked.error());
  }
  Guidance guidance;
  guidance.stamp = now;
  guidance.world = belief.world;
  guidance.robot = request.robot;
  guidance.revision = last_revision + 1;
  guidance.path = request.path;
  guidance.given_by = client;
  guidance.belief_revision = belief.revision;
  guidance.answers_snapshot = request.answers_snapshot;
  guidance.valid_until = {now.nanoseconds + SimTime::FromSeconds(request.valid_for_s).nanoseconds};
  return guidance;
}

}  // namespace conav::operators
