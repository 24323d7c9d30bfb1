#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "bench/console/measurement.h"

namespace conav::bench {

inline constexpr double kAgeBarMs = 100.0;  // p95 of the age in the page
inline constexpr double kStallBarMb = 8.0;

struct Series {
  int pages = 0;
  std::vector<Round> rounds;
};

/// One browser stands still: the others, and the service, in as long a while before and meanwhile.
struct Stall {
  int pages = 0;
  Round before;
  Round meanwhile;
};

struct Report {
  LoadOptions load;
  std::size_t picture_bytes = 0;
  double seconds = 0.0;  // of one round
  std::vector<Series> series;
  std::optional<Stall> stall;
};

/// What was played, what an age is, a line for each number of pages, and the bars.
void PrintTable(const Report& report);

/// One object: `metrics` and, under `details`, every round.
nlohmann::ordered_json ToJson(const Report& report);

}  // namespace conav::bench
