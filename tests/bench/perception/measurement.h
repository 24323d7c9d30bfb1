#pragma once

#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

#include "common/msg/perception_model.h"

namespace conav::bench {

/// One way of asking: in this process, or a service on a DDS vendor.
struct Asked {
  std::string name;  // "embedded", "cyclonedds", "fastdds"
  PerceptionModel& model;
};

/// Median wall time of a call, for each repetition, of one way and one size of batch.
struct Series {
  std::string name;
  std::size_t batch = 1;
  std::vector<double> call_us;
};

/// Asks every model the same batches in turn, `calls` of each size in each of `rounds`. The first
/// model is the reference: throws StartupError when another fails or answers with other bits.
std::vector<Series> Measure(std::span<const Asked> models, std::span<const PerceptionQuery> queries,
                            int rounds, int calls);

/// "<name>_<single|batch32>_us", a call, and "<name>_<...>_ratio", over the first name's.
nlohmann::ordered_json MetricsOf(std::span<const Series> series);

}  // namespace conav::bench
