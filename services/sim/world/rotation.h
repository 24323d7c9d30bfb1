#pragma once

#include "common/runtime/result.h"
#include "sim/world/world_spec.h"

namespace conav::sim {

/// The same world seen by somebody who stands turned: truth, operator's map, textures, starts, goals
/// and the robots' first heading, all turned counter-clockwise around the middle. Rows and columns
/// change places at 90 and 270 degrees. Paper, section 6.2: layouts are used again, rotated.
/// Errors: kOutOfRange when `rotation_deg` is not 0, 90, 180 or 270.
[[nodiscard]] Result<WorldSpec> Rotated(WorldSpec spec, int rotation_deg);

}  // namespace conav::sim
