#include "bench/bus/rounds.h"

#include "bench/support/measure.h"
#include "common/bus/backend.h"

namespace conav::bench {
namespace {

/// As many messages as take a comparable time at each size.
std::uint64_t FloodLength(std::size_t size, std::uint64_t trips) {
  return size > 1000 ? trips : trips * 10;
}

void MeasureRound(Traffic& bus, Traffic& raw, int round, std::uint64_t trips, Series& series) {
  const auto measure_bus = [&] { series.bus.push_back(bus.MeasureRoundTrips(series.size, trips)); };
  const auto measure_raw = [&] { series.raw.push_back(raw.MeasureRoundTrips(series.size, trips)); };
  if (round % 2 == 0) {
    measure_bus();
    measure_raw();
  } else {
    measure_raw();
    measure_bus();
  }
  const std::uint64_t flood = FloodLength(series.size, trips);
  series.bus_rate.push_back(bus.MeasureRate(series.size, flood));
  series.raw_rate.push_back(raw.MeasureRate(series.size, flood));
}

}  // namespace

std::vector<Series> RunRounds(const RoundsOptions& options) {
  std::vector<Series> result;
  for (const char* vendor : {bus::kCycloneDds, bus::kFastDds}) {
    Traffic bus({vendor, false, options.bus_domain}, options.own_program);
    Traffic raw({vendor, true, options.raw_domain}, options.own_program);
    Series small{vendor, kSmall, {}, {}, {}, {}};
    Series large{vendor, kLarge, {}, {}, {}, {}};
    for (int round = 0; round < options.rounds; ++round) {
      MeasureRound(bus, raw, round, options.trips, small);
      MeasureRound(bus, raw, round, options.trips, large);
    }
    result.push_back(std::move(small));
    result.push_back(std::move(large));
  }
  return result;
}

std::vector<double> Values(const std::vector<RoundTrips>& rounds, double RoundTrips::*value) {
  std::vector<double> values;
  for (const RoundTrips& round : rounds) values.push_back(round.*value);
  return values;
}

double Ratio(const Series& series) {
  return MedianRatio(Values(series.bus, &RoundTrips::p50_us),
                     Values(series.raw, &RoundTrips::p50_us));
}

}  // namespace conav::bench
