#pragma once

#include "common/runtime/result.h"
#include "launcher/demo_options.h"
#include "sim/world/world_spec.h"

namespace conav::launcher {

/// What the simulator of a world makes it from; `index` counts the worlds from 0.
sim::WorldOptions WorldOptionsOf(const DemoOptions& options, int index);

/// Makes every world of the run as its simulator will, so that one that cannot be is refused before
/// anything starts. Errors: an unknown --preset, a map file's own, more --robots than a world has
/// room for (and for how many it has).
[[nodiscard]] Result<void> CheckWorlds(const DemoOptions& options);

}  // namespace conav::launcher
