// conav-bench-perception: what a perception query costs in the planner's own process and as a
// request to conav-nhpm, a process of its own, over both DDS vendors.
#include <fmt/core.h>

#include <filesystem>
#include <span>

#include "bench/nhpm/planner_queries.h"
#include "bench/support/bench_program.h"
#include "common/bus/participant.h"
#include "common/runtime/file.h"
#include "launcher/process.h"
#include "nhpm/config.h"
#include "planner/perception/remote_model.h"
#include "support/loopback.h"
#include "support/test_weights.h"

namespace conav::bench {
namespace {

namespace fs = std::filesystem;

launcher::Process StartService(const std::string& vendor, int domain, const fs::path& weights,
                               const fs::path& folder) {
  nhpm::NhpmConfig config;
  config.bus = test::OnLoopback(vendor, domain);
  config.model = PerceptionModelKind::kNhpm;
  config.weights = weights.string();
  const fs::path file = folder / (vendor + ".yaml");
  if (const auto written = WriteFile(file, DumpConfig("nhpm", config)); !written) {
    throw StartupError(written.error().text);
  }
  const fs::path program = fs::read_symlink("/proc/self/exe").parent_path() / "conav-nhpm";
  return {"conav-nhpm", {program.string(), "--config", file.string()}, folder / (vendor + ".log")};
}

/// conav-nhpm as a process of its own on one DDS vendor, and a planner's side that asks it, on the
/// loopback interface in a domain of their own.
struct ServedNetwork {
  /// Config and log go into `folder`. Throws StartupError.
  ServedNetwork(const std::string& vendor, const fs::path& weights, const fs::path& folder)
      : process(StartService(vendor, domain.domain(), weights, folder)),
        participant("planner", test::OnLoopback(vendor, domain.domain())),
        model(participant, {.model = "nhpm", .timeout = std::chrono::seconds(60)}) {}

  launcher::DomainLease domain = test::LeaseDomain();
  launcher::Process process;
  bus::Participant participant;
  planner::RemotePerceptionModel model;
};

/// One way of asking: in this process, or a service on a DDS vendor.
struct Asked {
  std::string name;  // "embedded", "cyclonedds", "fastdds"
  PerceptionModel& model;
};

constexpr std::pair<const char*, std::size_t> kBatches[] = {{"single", 1}, {"batch32", 32}};

using Answers = std::vector<PerceptionAnswer>;

Answers Ask(const Asked& asked, std::span<const PerceptionQuery> queries) {
  auto answers = asked.model.Predict(queries);
  if (!answers) throw StartupError(fmt::format("{}: {}", asked.name, answers.error().text));
  return *std::move(answers);
}

/// Of calls with `size` queries each, going around in all of them.
double MedianCall(const Asked& asked, std::span<const PerceptionQuery> queries, std::size_t size,
                  int calls) {
  std::vector<double> us;
  for (int i = 0; i < calls; ++i) {
    const std::size_t at = static_cast<std::size_t>(i) * size % (queries.size() - size + 1);
    const auto batch = queries.subspan(at, size);
    us.push_back(1e6 * WallSecondsOf([&] { Ask(asked, batch); }));
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

/// Asks every model the same batches in turn, `calls` of each size: "<name>_<size>_us", a call, and
/// "<name>_<size>_ratio", over the first model's.
void MeasureRound(std::span<const Asked> models, std::span<const PerceptionQuery> queries,
                  int calls, Rounds& rounds) {
  for (const auto& [label, size] : kBatches) {
    double reference_us = 0.0;
    for (const Asked& asked : models) {
      const std::string prefix = fmt::format("{}_{}", asked.name, label);
      const double us = MedianCall(asked, queries, size, calls);
      rounds.Add({{prefix + "_us", us}});
      if (&asked != &models.front()) rounds.Add({{prefix + "_ratio", us / reference_us}});
      if (&asked == &models.front()) reference_us = us;
    }
  }
}

struct Options {
  int calls = 200;
  std::string weights;
};

std::vector<PerceptionQuery> Queries() {
  std::vector<PerceptionQuery> queries;
  for (const auto& batch : RecordPlannerQueries(1, 1)) {
    queries.insert(queries.end(), batch.begin(), batch.end());
  }
  if (queries.size() > 256) queries.resize(256);
  return queries;
}

void PrintTable(const BenchProgram& program, const Options& options, const std::string& model,
                const Rounds& rounds) {
  fmt::print("{}, {}; wall time of a call, medians of {} rounds of {} calls\n", Machine(), model,
             program.rounds(), options.calls);
  fmt::print("{:<34} {:>12} {:>16} {:>10}\n", "", "one query", "32 queries", "a query");
  const auto figure = [&](const std::string& name, const char* rest) {
    return rounds.Median(name + rest);
  };
  for (const std::string name : {"embedded", "cyclonedds", "fastdds"}) {
    const double batch_us = figure(name, "_batch32_us");
    fmt::print("{:<34} {:>9.1f} us {:>13.1f} us {:>7.1f} us\n",
               name == "embedded" ? name : "conav-nhpm over " + name, figure(name, "_single_us"),
               batch_us, batch_us / 32.0);
  }
  for (const std::string name : {"cyclonedds", "fastdds"}) {
    fmt::print("{} over embedded: {:.2f} for one query, {:.2f} for 32\n", name,
               figure(name, "_single_ratio"), figure(name, "_batch32_ratio"));
  }
}

void Run(const BenchProgram& program, const Options& options) {
  const test::WeightsFolder folder;
  // The cost of a query does not depend on the values of the weights.
  const fs::path weights = fs::absolute(
      options.weights.empty() ? folder.Write("untrained", test::UntrainedNetwork(1, 0, 0, 32))
                              : options.weights);
  auto loaded = nhpm::LoadPerceptionModel(PerceptionModelKind::kNhpm, weights, {});
  if (!loaded) throw StartupError(loaded.error().text);
  PerceptionModel& embedded = **loaded;
  const std::string model =
      fmt::format("{} {}", embedded.identity().name, embedded.identity().version);
  ServedNetwork cyclone("cyclonedds", weights, folder.path());
  ServedNetwork fast("fastdds", weights, folder.path());
  const Asked models[] = {
      {"embedded", embedded}, {"cyclonedds", cyclone.model}, {"fastdds", fast.model}};
  const auto queries = Queries();
  RequireEqualBits(models, queries);
  Rounds rounds;
  program.ForEachRound([&] { MeasureRound(models, queries, options.calls, rounds); });
  PrintTable(program, options, model, rounds);
  program.Write({{"model", model},
                 {"rounds", program.rounds()},
                 {"calls", options.calls},
                 {"metrics", rounds.Medians()}});
}

}  // namespace
}  // namespace conav::bench

int main(int argc, char** argv) {
  using namespace conav::bench;
  BenchProgram program(
      "conav bench perception",
      "Cost of a perception query: in the planner's own process, and as a request to "
      "conav-nhpm,\n"
      "a process of its own on this machine, over Cyclone DDS and over Fast DDS; single and in\n"
      "batches of 32, all in one run, with queries of the planner's search and the same bits.\n"
      "Metrics of --json: <way>_single_us and <way>_batch32_us, the wall time of a call, for the\n"
      "ways embedded, cyclonedds, fastdds; <vendor>_single_ratio and <vendor>_batch32_ratio, over\n"
      "embedded.",
      15);
  Options options;
  program.AddNumber("--calls", options.calls, "Calls per repetition, way and size", 1, 100000);
  program.app().add_option("--weights", options.weights,
                           "Weights file [untrained ones of width 32]");
  return program.Run(argc, argv, [&] { Run(program, options); });
}
