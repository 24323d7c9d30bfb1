#pragma once

#include <string>

#include "common/protocol/supervision.h"
#include "common/runtime/result.h"

/// What a client may do to the belief and to guidance. Pure functions: the new value, or kRefused
/// with a reason that names the value and the limit and can be shown to a person as it is.
namespace conav::operators {

struct GuidanceLimits {
  double valid_for_s = 7200.0;  // simulation time
  int path_cells = 10000;
};

/// The belief after `request`: the edited cells at 0 or 1, revision + 1. Refused: no edits, a cell
/// outside of the map, on its border or named twice, a base revision that is not the current one
/// (the edits of somebody else came first; look again).
[[nodiscard]] Result<Belief> ApplyEdit(const Belief& current, const EditRequest& request,
                                       const std::string& client, SimTime now);

/// The guidance of `request` on `belief`; its revision is one above `last_revision`. An empty path
/// withdraws the guidance. Refused: cells outside of the map, steps that are not to a neighbour, a
/// path over the limit, valid_for_s not in (0, limit].
[[nodiscard]] Result<Guidance> MakeGuidance(const Belief& belief, const GuideRequest& request,
                                            std::uint64_t last_revision, const std::string& client,
                                            SimTime now, const GuidanceLimits& limits);

}  // namespace conav::operators
