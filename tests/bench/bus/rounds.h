#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "bench/bus/traffic.h"

namespace conav::bench {

/// What one vendor did at one payload size, a value for each round.
struct Series {
  std::string vendor;
  std::size_t size = 0;
  std::vector<RoundTrips> bus;
  std::vector<RoundTrips> raw;
  std::vector<double> bus_rate;  // messages per second
  std::vector<double> raw_rate;
};

struct RoundsOptions {
  int rounds = 0;
  std::uint64_t trips = 0;  // per round, stack and size
  std::string own_program;
  int bus_domain = 0;
  int raw_domain = 0;
};

inline constexpr std::size_t kSmall = 64;
inline constexpr std::size_t kLarge = 20'000;

/// Measures bus and raw in turn, round by round, so that both see the same machine. One Series per
/// vendor and size. Throws std::runtime_error.
std::vector<Series> RunRounds(const RoundsOptions& options);

/// One figure of each round.
std::vector<double> Values(const std::vector<RoundTrips>& rounds, double RoundTrips::*value);

/// The median over the rounds of bus p50 / raw p50.
double Ratio(const Series& series);

}  // namespace conav::bench
