#include "study/waterway.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "launcher/demo_plan.h"
#include "study/design.h"
#include "study/report_page.h"
#include "study/statistics/moments.h"

namespace conav::study {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr int kMostSeeds = 1000;

constexpr const char* kTitles[] = {"greedy", "ig-mcts", "ig-mcts, no operator"};
constexpr const char* kNames[] = {"greedy", "ig-mcts", "ig-mcts-alone"};

std::size_t IndexOf(Crossing crossing) { return static_cast<std::size_t>(crossing); }

double Mean(const std::vector<double>& values) {
  return values.empty() ? 0.0 : statistics::Mean(values);
}

/// Infinite without the goal.
double DrivenM(const EpisodeRecord& record) {
  return record.is_complete() ? record.measures->distance_m : kInfinity;
}

CrossingSummary SummariseCrossing(Crossing crossing, const WaterwayOptions& options,
                                  const WaterwayRecords& records) {
  CrossingSummary summary{.crossing = crossing};
  std::vector<double> ratios, pictures, guidance, accuracy;
  int shorter = 0;
  for (const WaterwayTrial& trial : TrialsOf(options)) {
    if (trial.crossing != crossing) continue;
    ++summary.trials;
    const EpisodeRecord& record = records.at(trial.name());
    if (record.is_complete()) ++summary.reached;
    const EpisodeRecord& greedy = records.at(WaterwayTrial{trial.seed, Crossing::kGreedy}.name());
    if (DrivenM(record) < DrivenM(greedy)) ++shorter;
    ratios.push_back(record.is_complete() && record.measures->optimal_distance_m > 0.0
                         ? record.measures->distance_m / record.measures->optimal_distance_m
                         : kInfinity);
    if (!record.measures) continue;
    pictures.push_back(record.measures->images);
    guidance.push_back(record.measures->guidance);
    accuracy.push_back(record.measures->mapping_accuracy_after);
    summary.decision_ms_p95 = std::max(summary.decision_ms_p95, record.measures->decision_ms_p95);
  }
  summary.path_over_optimum_median = statistics::Median(ratios);
  summary.path_over_optimum_mean = statistics::Mean(ratios);
  summary.shorter_than_greedy_fraction = static_cast<double>(shorter) / summary.trials;
  summary.path_over_optimum_worst = *std::ranges::max_element(ratios);
  summary.pictures_mean = Mean(pictures);
  summary.guidance_mean = Mean(guidance);
  summary.mapping_accuracy_mean = Mean(accuracy);
  return summary;
}

const CrossingSummary& Guided(const WaterwaySummary& summary) {
  return summary.crossings[IndexOf(Crossing::kGuided)];
}

double ReachedFraction(const CrossingSummary& summary) {
  return static_cast<double>(summary.reached) / summary.trials;
}

std::string Ratio(double value) {
  return std::isfinite(value) ? fmt::format("{:.2f}", value) : "not reached";
}

}  // namespace

const char* TitleOf(Crossing crossing) { return kTitles[IndexOf(crossing)]; }

Result<void> Validate(const WaterwayOptions& options) {
  if (auto ok = CheckRange("--seeds", options.seeds, 1, kMostSeeds); !ok) return ok;
  if (auto ok = CheckJobs(options.jobs); !ok) return ok;
  const launcher::DemoOptions demo =
      DemoOf({}, options, options.out.empty() ? "runs" : options.out);
  return launcher::Validate(demo).and_then([&] { return launcher::CheckWorlds(demo); });
}

std::string WaterwayTrial::name() const {
  return fmt::format("seed{:03}-{}", seed, kNames[IndexOf(crossing)]);
}

std::vector<WaterwayTrial> TrialsOf(const WaterwayOptions& options) {
  std::vector<WaterwayTrial> trials;
  for (int i = 0; i < options.seeds; ++i) {
    for (const Crossing crossing : kCrossings) {
      trials.push_back({options.first_seed + static_cast<std::uint64_t>(i), crossing});
    }
  }
  return trials;
}

nlohmann::ordered_json DesignOf(const WaterwayOptions& options) {
  return {{"world", "waterway"},
          {"crossings", kNames},
          {"seeds", options.seeds},
          {"first_seed", options.first_seed},
          {"camera", options.camera},
          {"dds", options.dds},
          {"weights_checksum", launcher::WeightsChecksum(DemoOf({}, options, "runs"))},
          {"time_limit_s", options.time_limit_s}};
}

launcher::DemoOptions DemoOf(const WaterwayTrial& trial, const WaterwayOptions& options,
                             const std::filesystem::path& folder) {
  launcher::DemoOptions demo;
  demo.world = "waterway";
  demo.headless = true;
  demo.seed = trial.seed;
  demo.camera = options.camera;
  demo.dds = options.dds;
  demo.time_limit_s = options.time_limit_s;
  demo.out = folder;
  if (trial.crossing == Crossing::kGreedy) demo.method = MethodKind::kGreedy;
  if (trial.crossing == Crossing::kAlone) demo.communication = "never";
  if (trial.crossing != Crossing::kGuided) demo.simulated_operator = "silent";
  return demo;
}

WaterwaySummary Summarise(const WaterwayOptions& options, const WaterwayRecords& records) {
  WaterwaySummary summary;
  for (const Crossing crossing : kCrossings) {
    summary.crossings.push_back(SummariseCrossing(crossing, options, records));
  }
  for (const WaterwayTrial& trial : TrialsOf(options)) {
    if (records.at(trial.name()).has_failed()) summary.failed.push_back(trial.name());
  }
  return summary;
}

std::vector<WaterwayBar> BarsOf(const WaterwaySummary& summary) {
  const CrossingSummary& guided = Guided(summary);
  return {{"share of goals reached with an operator", ReachedFraction(guided), 1.0, true},
          {"median path over the optimum", guided.path_over_optimum_median, 1.3},
          {"share of maps with a path shorter than greedy's", guided.shorter_than_greedy_fraction,
           0.8, true},
          {"95th percentile of decision times, ms", guided.decision_ms_p95, 1000.0}};
}

std::string WaterwayText(const WaterwaySummary& summary) {
  ReportSection table{
      .title = "Waterways, simulated operator",
      .header = {"", "reached", "path / optimum", "mean", "worst", "shorter than greedy",
                 "pictures", "paths given", "mapping", "p95 ms"},
      .rows = {},
      .remarks = {}};
  for (const CrossingSummary& one : summary.crossings) {
    table.rows.push_back({TitleOf(one.crossing), fmt::format("{} of {}", one.reached, one.trials),
                          Ratio(one.path_over_optimum_median), Ratio(one.path_over_optimum_mean),
                          Ratio(one.path_over_optimum_worst),
                          fmt::format("{:.0f} %", 100.0 * one.shorter_than_greedy_fraction),
                          fmt::format("{:.1f}", one.pictures_mean),
                          fmt::format("{:.1f}", one.guidance_mean),
                          fmt::format("{:.2f}", one.mapping_accuracy_mean),
                          fmt::format("{:.0f}", one.decision_ms_p95)});
  }
  table.remarks = {
      "path / optimum: metres driven over the shortest drive on the true map; median, mean",
      "p95 ms: wall time of decisions, of the crossing with the largest"};
  ReportSection bars{
      .title = "Bars", .header = {"", "measured", "bar", ""}, .rows = {}, .remarks = {}};
  for (const WaterwayBar& bar : BarsOf(summary)) {
    bars.rows.push_back({bar.title, Ratio(bar.value),
                         fmt::format("{} {:g}", bar.at_least ? "at least" : "at most", bar.limit),
                         bar.met() ? "met" : "MISSED"});
  }
  for (const std::string& name : summary.failed) bars.remarks.push_back(name + " failed");
  return SectionsText(std::vector{table, bars});
}

nlohmann::ordered_json WaterwayJson(const WaterwaySummary& summary,
                                    const nlohmann::ordered_json& design) {
  const CrossingSummary& guided = Guided(summary);
  nlohmann::ordered_json crossings = nlohmann::ordered_json::array();
  for (const CrossingSummary& one : summary.crossings) {
    crossings.push_back({{"crossing", kNames[IndexOf(one.crossing)]},
                         {"trials", one.trials},
                         {"reached", one.reached},
                         {"path_over_optimum_median", NumberJson(one.path_over_optimum_median)},
                         {"path_over_optimum_mean", NumberJson(one.path_over_optimum_mean)},
                         {"path_over_optimum_worst", NumberJson(one.path_over_optimum_worst)},
                         {"shorter_than_greedy_fraction", one.shorter_than_greedy_fraction},
                         {"pictures_mean", one.pictures_mean},
                         {"guidance_mean", one.guidance_mean},
                         {"mapping_accuracy_mean", one.mapping_accuracy_mean},
                         {"decision_p95_ms", one.decision_ms_p95}});
  }
  nlohmann::ordered_json bars = nlohmann::ordered_json::array();
  for (const WaterwayBar& bar : BarsOf(summary)) {
    bars.push_back({{"title", bar.title},
                    {"value", NumberJson(bar.value)},
                    {bar.at_least ? "at_least" : "at_most", bar.limit},
                    {"met", bar.met()}});
  }
  return {{"waterway",
           {{"reached_fraction", ReachedFraction(guided)},
            {"path_over_optimum_median", NumberJson(guided.path_over_optimum_median)},
            {"shorter_than_greedy_fraction", guided.shorter_than_greedy_fraction},
            {"decision_p95_ms", guided.decision_ms_p95}}},
          {"operator", "simulated"},
          {"crossings", std::move(crossings)},
          {"bars", std::move(bars)},
          {"failed", summary.failed},
          {"design", design}};
}

std::string WaterwayCsv(const WaterwayOptions& options, const WaterwayRecords& records) {
  std::string csv =
      "seed,crossing,status,path_m,optimum_m,pictures,paths_given,mapping_accuracy,time_s,"
      "decision_p95_ms\n";
  for (const WaterwayTrial& trial : TrialsOf(options)) {
    const EpisodeRecord& record = records.at(trial.name());
    csv +=
        fmt::format("{},{},{}", trial.seed, kNames[IndexOf(trial.crossing)], NameOf(record.status));
    const EpisodeMeasures measures = record.measures.value_or(EpisodeMeasures{});
    csv += fmt::format(",{:.2f},{:.2f},{},{},{:.4f},{:.2f},{:.1f}\n", measures.distance_m,
                       measures.optimal_distance_m, measures.images, measures.guidance,
                       measures.mapping_accuracy_after, measures.time_s, measures.decision_ms_p95);
  }
  return csv;
}

}  // namespace conav::study
