#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "bench/bus/rounds.h"

namespace conav::bench {

struct Report {
  std::vector<Series> series;
  std::optional<RoundTrips> ddsperf_small;
  std::optional<RoundTrips> ddsperf_large;
};

void PrintTable(const Report& report);

/// One object: `metrics` {cyclonedds_64B_ratio, cyclonedds_20kB_ratio, fastdds_64B_ratio,
/// fastdds_20kB_ratio}, each the median over the rounds of our round trip over the raw one, and
/// `details` with every round.
nlohmann::ordered_json ToJson(const Report& report);

}  // namespace conav::bench
