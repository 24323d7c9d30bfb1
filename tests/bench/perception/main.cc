// conav-bench-perception: what a perception query costs in the planner's own process and as a
// request to conav-nhpm, a process of its own, over both DDS vendors.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

#include "bench/nhpm/planner_queries.h"
#include "bench/support/bench_program.h"
#include "bench/support/measure.h"
#include "common/bus/participant.h"
#include "common/msg/perception_model.h"
#include "common/runtime/file.h"
#include "launcher/domain_lease.h"
#include "launcher/process.h"
#include "nhpm/config.h"
#include "nhpm/model/load_model.h"
#include "planner/perception/remote_model.h"
#include "support/test_domain.h"
#include "support/test_weights.h"

namespace conav::bench {
namespace {

/// conav-nhpm as a process of its own on one DDS vendor, and a planner's side that asks it, on the
/// loopback interface in a domain of their own.
class ServedNetwork {
 public:
  /// Config and log go into `folder`. Throws StartupError.
  ServedNetwork(const std::string& vendor, const std::filesystem::path& weights,
                const std::filesystem::path& folder);

  const std::string& vendor() const { return vendor_; }
  PerceptionModel& model() { return model_; }

 private:
  std::string vendor_;
  launcher::DomainLease domain_;
  launcher::Process process_;
  bus::Participant participant_;
  planner::RemotePerceptionModel model_;
};

namespace fs = std::filesystem;

bus::ParticipantOptions BusOn(const std::string& vendor, int domain) {
  bus::ParticipantOptions bus;
  bus.vendor = bus::ParseVendor(vendor).value();
  bus.domain_id = domain;
  bus.interface = "lo";
  return bus;
}

launcher::Process StartService(const std::string& vendor, int domain, const fs::path& weights,
                               const fs::path& folder) {
  nhpm::NhpmConfig config;
  config.bus = BusOn(vendor, domain);
  config.model = "nhpm";
  config.weights = weights.string();
  const fs::path file = folder / (vendor + ".yaml");
  if (const auto written = WriteFile(file, DumpConfig("nhpm", config)); !written) {
    throw StartupError(written.error().text);
  }
  const fs::path program = fs::read_symlink("/proc/self/exe").parent_path() / "conav-nhpm";
  return {"conav-nhpm", {program.string(), "--config", file.string()}, folder / (vendor + ".log")};
}

ServedNetwork::ServedNetwork(const std::string& vendor, const fs::path& weights,
                             const fs::path& folder)
    : vendor_(vendor),
      domain_(test::LeaseDomain()),
      process_(StartService(vendor, domain_.domain(), weights, folder)),
      participant_("planner", BusOn(vendor, domain_.domain())),
      model_(participant_, {.model = "nhpm", .timeout = std::chrono::seconds(60)}) {}

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

/// Asks every model the same batches in turn, `calls` of each size in each of `rounds`. The first
/// model is the reference: throws StartupError when another fails or answers with other bits.
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

/// "<name>_<single|batch32>_us", a call, and "<name>_<...>_ratio", over the first name's.
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
  auto loaded = nhpm::LoadPerceptionModel(PerceptionModelKind::kNhpm, weights, {});
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

using namespace conav::bench;

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
  Options options;
  AddUsualOptions(app, options.json, options.rounds);
  AddNumber(app, "--calls", options.calls, "Calls per repetition, way and size", {1, 100000});
  app.add_option("--weights", options.weights, "Weights file [untrained ones of width 32]");
  return RunBenchmark(app, argc, argv, [&] { Run(options); });
}
