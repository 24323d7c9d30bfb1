#include "bench/perception/measurement.h"

#include <fmt/format.h>

#include <chrono>

#include "bench/support/bench_program.h"
#include "bench/support/measure.h"

namespace conav::bench {
namespace {

constexpr std::size_t kBatches[] = {1, 32};

using Answers = std::vector<PerceptionAnswer>;

std::string Label(std::size_t batch) {
  return batch == 1 ? "single" : fmt::format("batch{}", batch);
}

Answers Ask(const Asked& asked, std::span<const PerceptionQuery> queries) {
  auto answers = asked.model.Predict(queries);
  if (!answers) throw StartupError(fmt::format("{}: {}", asked.name, answers.error().text));
  return *std::move(answers);
}

/// The `index`-th batch, going around in the queries.
std::span<const PerceptionQuery> BatchOf(std::span<const PerceptionQuery> queries, std::size_t size,
                                         std::size_t index) {
  const std::size_t places = queries.size() - size + 1;
  return queries.subspan(index * size % places, size);
}

double MedianCall(const Asked& asked, std::span<const PerceptionQuery> queries, std::size_t size,
                  int calls) {
  std::vector<double> us;
  for (int i = 0; i < calls; ++i) {
    const auto batch = BatchOf(queries, size, static_cast<std::size_t>(i));
    const auto start = std::chrono::steady_clock::now();
    Ask(asked, batch);
    us.push_back(std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - start)
                     .count());
  }
  return Median(std::move(us));
}

/// Also makes them find each other and warms them up.
void RequireEqualBits(std::span<const Asked> models, std::span<const PerceptionQuery> queries) {
  const Answers expected = Ask(models.front(), queries);
  for (const Asked& asked : models) {
    if (Ask(asked, queries) == expected) continue;
    throw StartupError(
        fmt::format("{} answers with other bits than {}", asked.name, models.front().name));
  }
}

}  // namespace

std::vector<Series> Measure(std::span<const Asked> models, std::span<const PerceptionQuery> queries,
                            int rounds, int calls) {
  RequireEqualBits(models, queries);
  std::vector<Series> series;
  for (const std::size_t batch : kBatches) {
    for (const Asked& asked : models) series.push_back({asked.name, batch, {}});
  }
  for (int round = 0; round < rounds; ++round) {
    ShowRound(round, rounds);
    for (std::size_t i = 0; i < series.size(); ++i) {
      series[i].call_us.push_back(
          MedianCall(models[i % models.size()], queries, series[i].batch, calls));
    }
  }
  return series;
}

nlohmann::ordered_json MetricsOf(std::span<const Series> series) {
  nlohmann::ordered_json metrics;
  const Series* first = nullptr;
  for (const Series& one : series) {
    if (first == nullptr || first->batch != one.batch) first = &one;
    const std::string prefix = one.name + "_" + Label(one.batch);
    metrics[prefix + "_us"] = Median(one.call_us);
    if (&one == first) continue;
    metrics[prefix + "_ratio"] = MedianRatio(one.call_us, first->call_us);
  }
  return metrics;
}

}  // namespace conav::bench
