#include <fmt/core.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "study/experiment/tradeoff.h"
#include "study/report_page.h"

namespace conav::planner {
namespace {

using study::NumberJson;
using Json = nlohmann::ordered_json;

std::string Text(double value) {
  return std::isfinite(value) ? fmt::format("{:+.1f}", value) : "-";
}

/// "-" where the curve of IG-MCTS does not get there.
std::string Text(const TradeoffDifference& difference) {
  if (!std::isfinite(difference.value)) return "-";
  return fmt::format("{} [{}, {}]", Text(difference.value), Text(difference.interval.low),
                     Text(difference.interval.high));
}

const char* Name(TradeoffVerdict verdict) {
  constexpr const char* kNames[]{"better", "alike", "worse", "beyond"};
  return kNames[static_cast<std::size_t>(verdict)];
}

std::string Line(const TradeoffSweep& sweep, const TradeoffRow& row) {
  std::string differences;
  if (row.search_less_this) {
    const TradeoffComparison& comparison = *row.search_less_this;
    differences = fmt::format("{:22}  {:22}  {}", Text(comparison.effort_at_equal_snapshots),
                              Text(comparison.snapshots_at_equal_effort), Name(comparison.verdict));
  }
  std::string line =
      fmt::format("{:14}  {:8}  {:>7}  {:18}  {:18}  {:18}  {:>8.1f}  {:>7.0f} %  {}",
                  sweep.experiment.variants[row.point].name, sweep.experiment.operators[row.person],
                  fmt::format("{}/{}", row.all_goals, row.episodes), FigureText(row.snapshots, 1),
                  FigureText(row.steps, 1), FigureText(row.moves, 1), row.guidance.mean,
                  100.0 * row.mapping_accuracy.mean, differences);
  line.erase(line.find_last_not_of(' ') + 1);
  return line + "\n";
}

std::string Line(const TradeoffSweep& sweep, const PolicyVerdict& verdict) {
  return fmt::format(
      "{:14}  {:8}  IG-MCTS is better at {} of {} points, worse at {}, beyond its curve {}{}\n",
      verdict.policy, sweep.experiment.operators[verdict.person], verdict.better, verdict.points,
      verdict.worse, verdict.beyond, verdict.dominated() ? ": dominated" : "");
}

Json ToJson(const TradeoffDifference& difference) {
  return {{"value", NumberJson(difference.value)},
          {"low", NumberJson(difference.interval.low)},
          {"high", NumberJson(difference.interval.high)}};
}

Json ToJson(const TradeoffSweep& sweep, const TradeoffRow& row) {
  const TradeoffPoint& point = sweep.points[row.point];
  Json json{{"policy", point.policy},
            {"parameter", point.parameter ? Json(*point.parameter) : Json()},
            {"operator", sweep.experiment.operators[row.person]},
            {"episodes", row.episodes},
            {"all_goals", row.all_goals},
            {"pictures", FigureJson(row.snapshots)},
            {"steps", FigureJson(row.steps)},
            {"moves", FigureJson(row.moves)},
            {"guidance", FigureJson(row.guidance)},
            {"mapping_accuracy", FigureJson(row.mapping_accuracy)}};
  if (row.search_less_this) {
    const TradeoffComparison& comparison = *row.search_less_this;
    json["search_less_this"] = {
        {"effort_at_equal_pictures", ToJson(comparison.effort_at_equal_snapshots)},
        {"pictures_at_equal_effort", ToJson(comparison.snapshots_at_equal_effort)},
        {"verdict", Name(comparison.verdict)}};
  }
  return json;
}

/// Over the policies that send pictures.
std::string BarLine(const std::vector<PolicyVerdict>& verdicts) {
  int better = 0, points = 0;
  for (const PolicyVerdict& verdict : verdicts) {
    if (verdict.policy == "never" || verdict.policy == "greedy") continue;
    better += verdict.better;
    points += verdict.points;
  }
  return fmt::format("bar: better than every policy that sends pictures: {} of {} points: {}\n",
                     better, points, better == points ? "met" : "MISSED");
}

}  // namespace

std::string TradeoffTable(const TradeoffSweep& sweep, const std::vector<TradeoffRow>& rows) {
  const SearchExperiment& experiment = sweep.experiment;
  std::string text = fmt::format(
      "SIMULATED operators, {}; means [95 % bootstrap interval].\n"
      "Steps: low-level control steps (0.25 s), estimated from moves and turning.\n"
      "Last columns: IG-MCTS (search) less this policy in {}, interpolated over its costs of a "
      "picture; '-' where it does not get there ('beyond': it nowhere sends so few).\n\n"
      "{:14}  {:8}  {:>7}  {:18}  {:18}  {:18}  {:>8}  {:>9}  {:22}  {:22}\n",
      MazesText(experiment), Name(sweep.effort), "policy", "operator", "goals", "pictures", "steps",
      "moves", "guidance", "map right", fmt::format("{}, equal pictures", Name(sweep.effort)),
      fmt::format("pictures, equal {}", Name(sweep.effort)));
  for (const TradeoffRow& row : rows) text += Line(sweep, row);
  text += "\n";
  const std::vector<PolicyVerdict> verdicts = JudgePolicies(sweep, rows);
  for (const PolicyVerdict& verdict : verdicts) text += Line(sweep, verdict);
  return text + BarLine(verdicts);
}

Json TradeoffJson(const TradeoffSweep& sweep, const std::vector<TradeoffRow>& rows) {
  const SearchExperiment& experiment = sweep.experiment;
  Json points = Json::array();
  for (const TradeoffRow& row : rows) points.push_back(ToJson(sweep, row));
  Json policies = Json::array();
  for (const PolicyVerdict& verdict : JudgePolicies(sweep, rows)) {
    policies.push_back({{"policy", verdict.policy},
                        {"operator", experiment.operators[verdict.person]},
                        {"points", verdict.points},
                        {"search_better", verdict.better},
                        {"search_worse", verdict.worse},
                        {"beyond", verdict.beyond},
                        {"dominated", verdict.dominated()}});
  }
  return {{"experiment", "tradeoff"},
          {"operators", "simulated"},
          {"preset", experiment.scenario.preset},
          {"search", experiment.search},
          {"first_seed", experiment.first_seed},
          {"seeds", experiment.seeds},
          {"effort", Name(sweep.effort)},
          {"points", std::move(points)},
          {"policies", std::move(policies)}};
}

std::string TradeoffCsv(const TradeoffSweep& sweep,
                        const std::vector<ExperimentEpisode>& episodes) {
  std::string text = fmt::format("policy,parameter,{},estimated_steps\n", kEpisodeColumns);
  for (const ExperimentEpisode& episode : episodes) {
    const TradeoffPoint& point = sweep.points[episode.variant];
    text += fmt::format("{},{},{},{:.1f}\n", point.policy,
                        point.parameter ? fmt::format("{:g}", *point.parameter) : "",
                        EpisodeCells(sweep.experiment, episode),
                        EstimatedLowLevelSteps(episode.result.moves, episode.result.turning_rad));
  }
  return text;
}

}  // namespace conav::planner
