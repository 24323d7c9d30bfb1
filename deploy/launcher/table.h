#pragma once

#include <string>

#include "launcher/metrics.h"

namespace conav::launcher {

/// The result of a run, one line per robot and a line for the maps. Everything left of the "median"
/// column is the same for the same seed (one robot); the two time columns are wall times.
std::string ResultTable(const EpisodeMetrics& metrics);

/// "12.3 kB", "1.0 MB".
std::string ShortBytes(std::uint64_t bytes);

}  // namespace conav::launcher
