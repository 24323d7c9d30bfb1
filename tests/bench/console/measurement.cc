#include "bench/console/measurement.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <thread>

namespace conav::bench {
namespace {

/// Counters at one time.
struct Counts {
  explicit Counts(const Stage& stage)
      : at(std::chrono::steady_clock::now()),
        service(stage.service.Used()),
        sent_bytes(stage.service.Metric("conav_console_sent_bytes_total")),
        load_cpu_s(stage.load.cpu_s()),
        bare_cpu_s(stage.bare.cpu_s()) {}

  std::chrono::steady_clock::time_point at;
  Usage service;
  double sent_bytes;
  double load_cpu_s;
  double bare_cpu_s;
};

void Append(std::vector<double>& all, const std::vector<double>& values) {
  all.insert(all.end(), values.begin(), values.end());
}

void AddPages(const std::vector<PageAges>& pages, Round& round) {
  std::vector<double> shown;
  std::vector<double> drawn;
  std::vector<double> any;
  for (const PageAges& page : pages) {
    Append(shown, page.shown);
    Append(drawn, page.drawn);
    Append(any, page.any);
    round.worst_page_p95_ms = std::max(round.worst_page_p95_ms, QuantilesOf(page.shown).p95);
    round.frames_per_s += page.frames_per_s / static_cast<double>(pages.size());
    round.states_per_s += page.states_per_s / static_cast<double>(pages.size());
  }
  round.shown = QuantilesOf(std::move(shown));
  round.drawn = QuantilesOf(std::move(drawn));
  round.any = QuantilesOf(std::move(any));
}

void AddCounts(const Counts& before, const Counts& after, int connections, Round& round) {
  const double seconds = std::chrono::duration<double>(after.at - before.at).count();
  round.service_cores = (after.service.cpu_s - before.service.cpu_s) / seconds;
  round.service_mb = after.service.memory_mb;
  round.service_grown_mb = after.service.memory_mb - before.service.memory_mb;
  round.load_cores = (after.load_cpu_s - before.load_cpu_s) / seconds;
  round.bare_cores = (after.bare_cpu_s - before.bare_cpu_s) / seconds;
  round.connection_kb_per_s =
      (after.sent_bytes - before.sent_bytes) / 1000.0 / seconds / connections;
}

}  // namespace

Quantiles QuantilesOf(std::vector<double> values) {
  if (values.empty()) return {};
  std::sort(values.begin(), values.end());
  const auto at = [&](double share) {
    const double index = std::ceil(share * static_cast<double>(values.size())) - 1.0;
    return values[static_cast<std::size_t>(std::max(0.0, index))];
  };
  return {at(0.5), at(0.95), at(0.99), values.back()};
}

Round MeasureRound(Stage& stage, double seconds, int connections) {
  Round round;
  stage.browsers.Begin();
  stage.bare.TakeAges();
  stage.load.TakeLatenessMs();
  const Counts before(stage);
  std::this_thread::sleep_for(std::chrono::duration<double>(seconds));
  const Counts after(stage);
  round.lateness_ms = stage.load.TakeLatenessMs();
  round.bare = QuantilesOf(stage.bare.TakeAges());
  const Browsers::Measured measured = stage.browsers.End();
  AddCounts(before, after, connections, round);
  AddPages(measured.pages, round);
  round.browser_cores =
      measured.cpu_s / std::chrono::duration<double>(after.at - before.at).count();
  return round;
}

}  // namespace conav::bench
