// conav-bench-perception: what a perception query costs in the planner's own process and as a
// request to conav-nhpm, a process of its own, over both DDS vendors.
#include <fmt/format.h>

#include <CLI/CLI.hpp>

#include "bench/nhpm/planner_queries.h"
#include "bench/perception/measurement.h"
#include "bench/perception/served_network.h"
#include "bench/support/bench_program.h"
#include "bench/support/measure.h"
#include "nhpm/model/load_model.h"
#include "support/test_weights.h"

namespace conav::bench {
namespace {

struct Options {
  int rounds = 15;
  int calls = 200;
  std::string weights;
  std::string json;
};

std::vector<PerceptionQuery> Queries() {
  std::vector<PerceptionQuery> queries;
  for (const auto& batch : RecordPlannerQueries(1, 1)) {
    queries.insert(queries.end(), batch.begin(), batch.end());
  }
  if (queries.size() > 256) queries.resize(256);
  return queries;
}

void PrintTable(const Options& options, const std::string& model,
                const nlohmann::ordered_json& metrics) {
  fmt::print("{}, {}; wall time of a call, medians of {} rounds of {} calls\n", Machine(), model,
             options.rounds, options.calls);
  fmt::print("{:<34} {:>12} {:>16} {:>10}\n", "", "one query", "32 queries", "a query");
  for (const char* name : {"embedded", "cyclonedds", "fastdds"}) {
    const auto us = [&](const char* batch) {
      return metrics[fmt::format("{}_{}_us", name, batch)].get<double>();
    };
    const std::string where =
        name == std::string("embedded") ? name : fmt::format("conav-nhpm over {}", name);
    fmt::print("{:<34} {:>9.1f} us {:>13.1f} us {:>7.1f} us\n", where, us("single"), us("batch32"),
               us("batch32") / 32.0);
  }
  for (const char* name : {"cyclonedds", "fastdds"}) {
    fmt::print("{} over embedded: {:.2f} for one query, {:.2f} for 32\n", name,
               metrics[fmt::format("{}_single_ratio", name)].get<double>(),
               metrics[fmt::format("{}_batch32_ratio", name)].get<double>());
  }
}

void Run(const Options& options) {
  const test::WeightsFolder folder;
  // What a query costs does not depend on the values of the weights.
  const std::filesystem::path weights = std::filesystem::absolute(
      options.weights.empty() ? folder.Write("untrained", test::UntrainedNetwork(1, 0, 0, 32))
                              : options.weights);
  auto loaded = nhpm::LoadPerceptionModel("nhpm", weights, {});
  if (!loaded) throw StartupError(loaded.error().text);
  const std::string model =
      fmt::format("{} {}", (*loaded)->identity().name, (*loaded)->identity().version);
  PerceptionModel& embedded = **loaded;
  ServedNetwork cyclone("cyclonedds", weights, folder.path());
  ServedNetwork fast("fastdds", weights, folder.path());
  const Asked models[] = {
      {"embedded", embedded}, {cyclone.vendor(), cyclone.model()}, {fast.vendor(), fast.model()}};
  const auto series = Measure(models, Queries(), options.rounds, options.calls);
  const auto metrics = MetricsOf(series);
  PrintTable(options, model, metrics);
  WriteFigures(options.json, {{"benchmark", "perception"},
                              {"machine", Machine()},
                              {"model", model},
                              {"rounds", options.rounds},
                              {"calls", options.calls},
                              {"metrics", metrics}});
}

}  // namespace
}  // namespace conav::bench

int main(int argc, char** argv) {
  CLI::App app(
      "What a perception query costs: in the planner's own process, and as a request to "
      "conav-nhpm,\n"
      "a process of its own on this machine, over Cyclone DDS and over Fast DDS; single and in\n"
      "batches of 32, all in one run, with queries of the planner's search and the same bits.\n"
      "Metrics of --json: <way>_single_us and <way>_batch32_us, the wall time of a call, for the\n"
      "ways embedded, cyclonedds, fastdds; <vendor>_single_ratio and <vendor>_batch32_ratio, over\n"
      "embedded.",
      "conav bench perception");
  conav::bench::Options options;
  conav::bench::AddUsualOptions(app, options.json, options.rounds);
  app.add_option("--calls", options.calls, "Calls per repetition, way and size")
      ->capture_default_str()
      ->check(CLI::Range(1, 100000));
  app.add_option("--weights", options.weights, "Weights file [untrained ones of width 32]");
  return conav::bench::RunBenchmark(app, argc, argv, [&] { conav::bench::Run(options); });
}
