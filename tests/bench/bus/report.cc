#include "bench/bus/report.h"

#include <fmt/format.h>

#include <cstdio>
#include <nlohmann/json.hpp>

#include "bench/support/measure.h"

namespace conav::bench {
namespace {

const char* SizeName(std::size_t size) { return size == kSmall ? "64B" : "20kB"; }

double MedianOf(const std::vector<RoundTrips>& rounds, double RoundTrips::*value) {
  return Median(Values(rounds, value));
}

nlohmann::ordered_json Details(const Series& series) {
  return {{"vendor", series.vendor},
          {"bytes", series.size},
          {"bus_p50_us", Values(series.bus, &RoundTrips::p50_us)},
          {"raw_p50_us", Values(series.raw, &RoundTrips::p50_us)},
          {"bus_p99_us", Values(series.bus, &RoundTrips::p99_us)},
          {"raw_p99_us", Values(series.raw, &RoundTrips::p99_us)},
          {"bus_messages_per_s", series.bus_rate},
          {"raw_messages_per_s", series.raw_rate}};
}

void PrintDdsperf(const char* size, const std::optional<RoundTrips>& measured) {
  if (!measured) return;
  fmt::print("ddsperf     {:>5}  {:>17}  {:8.1f} {:8.1f}\n", size, "", measured->p50_us,
             measured->p99_us);
}

}  // namespace

void PrintTable(const Report& report) {
  fmt::print("{}, loopback, medians of {} rounds\n", Machine(),
             report.series.empty() ? 0 : report.series[0].bus.size());
  fmt::print("                   bus p50/p99 us     raw p50/p99 us     ratio  bus/raw msg/s\n");
  for (const Series& series : report.series) {
    fmt::print("{:<11} {:>5}  {:8.1f} {:8.1f}  {:8.1f} {:8.1f}  {:8.3f}  {:.0f} / {:.0f}\n",
               series.vendor, SizeName(series.size), MedianOf(series.bus, &RoundTrips::p50_us),
               MedianOf(series.bus, &RoundTrips::p99_us), MedianOf(series.raw, &RoundTrips::p50_us),
               MedianOf(series.raw, &RoundTrips::p99_us), Ratio(series), Median(series.bus_rate),
               Median(series.raw_rate));
  }
  PrintDdsperf("64B", report.ddsperf_small);
  PrintDdsperf("20kB", report.ddsperf_large);
}

nlohmann::ordered_json ToJson(const Report& report) {
  nlohmann::ordered_json json;
  json["benchmark"] = "bus";
  json["machine"] = Machine();
  for (const Series& series : report.series) {
    json["metrics"][fmt::format("{}_{}_ratio", series.vendor, SizeName(series.size))] =
        Ratio(series);
    json["details"].push_back(Details(series));
  }
  const auto add_ddsperf = [&](const char* size, const std::optional<RoundTrips>& measured) {
    if (!measured) return;
    json["ddsperf"][size] = {{"p50_us", measured->p50_us}, {"p99_us", measured->p99_us}};
  };
  add_ddsperf("64B", report.ddsperf_small);
  add_ddsperf("20kB", report.ddsperf_large);
  return json;
}

}  // namespace conav::bench
