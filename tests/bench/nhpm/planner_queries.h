#pragma once

#include <cstdint>
#include <vector>

#include "common/msg/planning.h"

namespace conav::bench {

/// Batches in the order asked.
using QueryBatches = std::vector<std::vector<PerceptionQuery>>;

/// What the planner's search really asks: the batches of whole episodes of the default search in
/// mazes of 13 x 13 cells (seeds `first_seed` and the next ones), in process, with a fake model and
/// a simulated operator.
QueryBatches RecordPlannerQueries(int episodes, std::uint64_t first_seed);

}  // namespace conav::bench
