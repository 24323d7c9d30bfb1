#include "study/experiment/scenarios.h"

#include <fmt/core.h>

#include <algorithm>
#include <nlohmann/json.hpp>

namespace conav::planner {
namespace {

constexpr double kPictureBytes = 180.0 * 1024.0;
constexpr double kMebibyte = 1024.0 * 1024.0;

using Episodes = std::span<const ExperimentEpisode>;
using Get = std::function<double(const EpisodeResult&)>;

/// The episodes of one method and operator, by maze.
Episodes EpisodesOf(const ScenarioResult& result, std::size_t variant, std::size_t person) {
  const auto seeds = static_cast<std::size_t>(result.experiment.seeds);
  const std::size_t people = result.experiment.operators.size();
  return Episodes(result.episodes).subspan((variant * people + person) * seeds, seeds);
}

std::size_t IndexOf(const ScenarioResult& result, const std::string& method) {
  const auto& variants = result.experiment.variants;
  const auto found = std::ranges::find(variants, method, &SearchVariant::name);
  DEMAND(found != variants.end(), method);
  return static_cast<std::size_t>(found - variants.begin());
}

Get Steps(const SearchVariant& variant) {
  return [&variant](const EpisodeResult& result) { return StepsOf(variant, result); };
}

double GoalsShare(const EpisodeResult& result) {
  return static_cast<double>(result.goals_reached) / result.goals;
}

/// Of the difference of two methods in the same mazes.
Figure PairedDifference(Episodes a, const Get& get_a, Episodes b, const Get& get_b) {
  std::vector<double> differences;
  for (std::size_t i = 0; i < a.size(); ++i) {
    differences.push_back(get_a(a[i].result) - get_b(b[i].result));
  }
  return {statistics::Mean(differences), BootstrapMean(differences, kBootstrapSeed)};
}

/// One method with one operator.
struct Row {
  Episodes episodes;
  Figure steps;
  Figure pictures;
  double goals = 0.0;
};

Row RowOf(const ScenarioResult& result, std::size_t variant, std::size_t person) {
  const Episodes episodes = EpisodesOf(result, variant, person);
  return {episodes, FigureOf(episodes, Steps(result.experiment.variants[variant])),
          FigureOf(episodes, &EpisodeResult::snapshots), FigureOf(episodes, GoalsShare).mean};
}

bool IsShorter(const Row& ours, const Row& theirs) {
  return ours.steps.mean <= (1.0 - kLeastSaving) * theirs.steps.mean &&
         ours.steps.interval.high < theirs.steps.interval.low;
}

/// Rules about when to send a picture, but never.
bool IsRule(const SearchVariant& variant) {
  return variant.method == MethodKind::kIgMcts && variant.communication.policy != "search" &&
         variant.communication.policy != "never";
}

bool PerceptionMatters(const ScenarioResult& result, std::size_t person) {
  const std::size_t ours = IndexOf(result, "ig-mcts");
  const std::size_t theirs = IndexOf(result, "ig-mcts-glpf");
  const Episodes a = EpisodesOf(result, ours, person);
  const Episodes b = EpisodesOf(result, theirs, person);
  const Figure steps = PairedDifference(a, Steps(result.experiment.variants[ours]), b,
                                        Steps(result.experiment.variants[theirs]));
  const Figure pictures =
      PairedDifference(a, &EpisodeResult::snapshots, b, &EpisodeResult::snapshots);
  const double theirs_mean = FigureOf(b, Steps(result.experiment.variants[theirs])).mean;
  return steps.interval.high < 0.0 ||
         (pictures.interval.high < 0.0 && steps.mean <= (kEqualSteps - 1.0) * theirs_mean);
}

nlohmann::ordered_json FiguresJson(const SearchVariant& variant, Episodes episodes) {
  const Figure pictures = FigureOf(episodes, &EpisodeResult::snapshots);
  return {{"steps_mean", FigureOf(episodes, Steps(variant)).mean},
          {"bytes_mean", kPictureBytes * pictures.mean},
          {"pictures_mean", pictures.mean},
          {"mapping_accuracy_mean", FigureOf(episodes, &EpisodeResult::mapping_accuracy).mean},
          {"goals_reached_fraction", FigureOf(episodes, GoalsShare).mean},
          {"moves_mean", FigureOf(episodes, &EpisodeResult::moves).mean},
          {"guidance_mean", FigureOf(episodes, &EpisodeResult::guidance).mean}};
}

nlohmann::ordered_json MethodJson(const ScenarioResult& result, std::size_t variant) {
  const SearchVariant& method = result.experiment.variants[variant];
  const std::size_t people = result.experiment.operators.size();
  const Episodes first = EpisodesOf(result, variant, 0);
  nlohmann::ordered_json json = FiguresJson(method, Episodes(first.data(), first.size() * people));
  for (std::size_t person = 0; person < people; ++person) {
    const Row row = RowOf(result, variant, person);
    nlohmann::ordered_json own = FiguresJson(method, row.episodes);
    own["steps"] = FigureJson(row.steps);
    own["pictures"] = FigureJson(row.pictures);
    json["operators"][result.experiment.operators[person]] = std::move(own);
  }
  return json;
}

}  // namespace

ScenarioVerdict Judge(const ScenarioResult& result, std::size_t person) {
  const Row ours = RowOf(result, IndexOf(result, "ig-mcts"), person);
  const Row greedy = RowOf(result, IndexOf(result, "greedy"), person);
  const Row never = RowOf(result, IndexOf(result, "never"), person);
  ScenarioVerdict verdict;
  verdict.steps_over_greedy = ours.steps.mean / greedy.steps.mean;
  verdict.steps_over_never = ours.steps.mean / never.steps.mean;
  verdict.perception_matters = PerceptionMatters(result, person);
  const bool reaches_more = ours.goals == 1.0 && never.goals < 1.0;
  if (!reaches_more && !IsShorter(ours, greedy)) {
    verdict.reason = "greedy";
  } else if (!reaches_more && !IsShorter(ours, never)) {
    verdict.reason = "never-send";
  }
  for (std::size_t i = 0; i < result.experiment.variants.size() && verdict.reason.empty(); ++i) {
    if (!IsRule(result.experiment.variants[i])) continue;
    const Row rule = RowOf(result, i, person);
    if (rule.steps.mean <= kEqualSteps * ours.steps.mean &&
        rule.pictures.mean <= ours.pictures.mean) {
      verdict.reason = result.experiment.variants[i].name;
    }
  }
  verdict.person_matters = verdict.reason.empty();
  return verdict;
}

std::string ScenarioTable(const ScenarioResult& result) {
  const SearchExperiment& experiment = result.experiment;
  std::string text = fmt::format(
      "{}: {}\nSIMULATED operators, {}; means [95 % bootstrap interval]\n"
      "{:13}  {:8}  {:>6}  {:26}  {:20}  {:>6}  {:>8}  {:>9}\n",
      experiment.scenario.name, experiment.scenario.about, MazesText(experiment), "method",
      "operator", "goals", "steps", "pictures", "MiB", "guidance", "map right");
  for (std::size_t variant = 0; variant < experiment.variants.size(); ++variant) {
    for (std::size_t person = 0; person < experiment.operators.size(); ++person) {
      const Row row = RowOf(result, variant, person);
      text += fmt::format("{:13}  {:8}  {:4.0f} %  {:26}  {:20}  {:6.1f}  {:8.1f}  {:7.0f} %\n",
                          experiment.variants[variant].name, experiment.operators[person],
                          100.0 * row.goals, FigureText(row.steps, 0), FigureText(row.pictures, 1),
                          kPictureBytes * row.pictures.mean / kMebibyte,
                          FigureOf(row.episodes, &EpisodeResult::guidance).mean,
                          100.0 * FigureOf(row.episodes, &EpisodeResult::mapping_accuracy).mean);
    }
  }
  for (std::size_t person = 0; person < experiment.operators.size(); ++person) {
    const ScenarioVerdict verdict = Judge(result, person);
    text += fmt::format(
        "{}: the person {}; NHPM {} GLPF; steps over greedy {:.2f}, over never-send {:.2f}\n",
        experiment.operators[person],
        verdict.person_matters ? "matters" : "does not matter, by " + verdict.reason,
        verdict.perception_matters ? "beats" : "does not beat", verdict.steps_over_greedy,
        verdict.steps_over_never);
  }
  return text + "\n";
}

nlohmann::ordered_json ScenariosJson(const std::vector<ScenarioResult>& results) {
  nlohmann::ordered_json person = nlohmann::ordered_json::array();
  nlohmann::ordered_json perception = nlohmann::ordered_json::array();
  nlohmann::ordered_json scenarios;
  for (const ScenarioResult& result : results) {
    const std::string& name = result.experiment.scenario.name;
    const ScenarioVerdict verdict = Judge(result, 0);
    if (verdict.person_matters) person.push_back(name);
    if (verdict.perception_matters) perception.push_back(name);
    for (std::size_t i = 0; i < result.experiment.variants.size(); ++i) {
      scenarios[name][result.experiment.variants[i].name] = MethodJson(result, i);
    }
  }
  const SearchExperiment& experiment = results.front().experiment;
  return {{"experiment", "scenarios"},           {"operators", "simulated"},
          {"search", experiment.search},         {"first_seed", experiment.first_seed},
          {"seeds", experiment.seeds},           {"judged_with", experiment.operators.front()},
          {"person_matters", std::move(person)}, {"perception_matters", std::move(perception)},
          {"scenarios", std::move(scenarios)}};
}

std::string ScenariosCsv(const std::vector<ScenarioResult>& results) {
  std::string text = fmt::format("scenario,method,{},steps\n", kEpisodeColumns);
  for (const ScenarioResult& result : results) {
    for (const ExperimentEpisode& episode : result.episodes) {
      const SearchVariant& variant = result.experiment.variants[episode.variant];
      text +=
          fmt::format("{},{},{},{:.1f}\n", result.experiment.scenario.name, variant.name,
                      EpisodeCells(result.experiment, episode), StepsOf(variant, episode.result));
    }
  }
  return text;
}

}  // namespace conav::planner
