#include <fmt/core.h>

#include <nlohmann/json.hpp>

#include "common/runtime/file.h"
#include "study/experiment/search_experiment.h"

namespace conav::planner {
namespace {

constexpr double kMostMovesRatio = 1.25;
constexpr double kMostSnapshots = 14.0;

/// What the default preset has to reach with the careful operator.
std::string BarLine(const VariantSummary& row) {
  const bool arrives = row.all_goals == row.episodes;
  const bool is_short = row.moves_ratio && row.moves_ratio->mean <= kMostMovesRatio;
  const bool is_quiet = row.snapshots.mean <= kMostSnapshots;
  const auto verdict = [](bool met) { return met ? "met" : "MISSED"; };
  return fmt::format(
      "bars of the default with the careful operator: all goals {}; moves / optimal tour at most "
      "{} {}; pictures at most {} {}\n",
      verdict(arrives), kMostMovesRatio, verdict(is_short), kMostSnapshots, verdict(is_quiet));
}

}  // namespace

std::string FigureText(const Figure& figure, int digits) {
  return fmt::format("{:.{}f} [{:.{}f}, {:.{}f}]", figure.mean, digits, figure.interval.low, digits,
                     figure.interval.high, digits);
}

nlohmann::ordered_json FigureJson(const Figure& figure) {
  return {{"mean", figure.mean}, {"low", figure.interval.low}, {"high", figure.interval.high}};
}

std::string EpisodeCells(const SearchExperiment& experiment, const ExperimentEpisode& episode) {
  const EpisodeResult& r = episode.result;
  return fmt::format("{},{},{},{},{},{},{},{},{},{},{:.6f},{:.6f}",
                     experiment.operators[episode.person], episode.seed, r.all_goals ? 1 : 0,
                     r.goals_reached, r.moves, r.optimal_moves, r.blocked, r.snapshots, r.guidance,
                     r.edits, r.mapping_accuracy, r.turning_rad);
}

namespace {

/// Calls `visit` with the name and a reference to each field that is kept. `Episode` is const or not.
template <class Episode, class Visit>
void VisitFields(Episode& episode, const Visit& visit) {
  auto& result = episode.result;
  visit("variant", episode.variant);
  visit("person", episode.person);
  visit("seed", episode.seed);
  visit("all_goals", result.all_goals);
  visit("goals_reached", result.goals_reached);
  visit("goals", result.goals);
  visit("moves", result.moves);
  visit("turning_rad", result.turning_rad);
  visit("optimal_moves", result.optimal_moves);
  visit("blocked", result.blocked);
  visit("snapshots", result.snapshots);
  visit("guidance", result.guidance);
  visit("edits", result.edits);
  visit("mapping_accuracy", result.mapping_accuracy);
  visit("time_s", result.time_s);
  visit("action_limit", result.action_limit);
  visit("decision_ms", result.decision_ms);
  visit("perception_queries", result.perception_queries);
  visit("perception_cached", result.perception_cached);
}

}  // namespace

nlohmann::ordered_json EpisodesJson(const std::vector<ExperimentEpisode>& episodes) {
  auto document = nlohmann::ordered_json::array();
  for (const ExperimentEpisode& episode : episodes) {
    auto& fields = document.emplace_back(nlohmann::ordered_json::object());
    VisitFields(episode, [&](const char* name, const auto& value) { fields[name] = value; });
  }
  return document;
}

Result<std::vector<ExperimentEpisode>> ReadEpisodes(const std::filesystem::path& file) {
  const auto text = ReadFile(file);
  if (!text) return tl::unexpected(text.error());
  std::vector<ExperimentEpisode> episodes;
  try {
    for (const auto& fields : nlohmann::json::parse(*text)) {
      ExperimentEpisode& episode = episodes.emplace_back();
      VisitFields(episode, [&](const char* name, auto& value) { fields.at(name).get_to(value); });
    }
  } catch (const nlohmann::json::exception& error) {
    return Fail(ErrorCode::kMalformed, fmt::format("{}: {}", file.string(), error.what()));
  }
  return episodes;
}

std::string MazesText(const SearchExperiment& experiment) {
  return fmt::format("mazes {} with seeds {} to {}", experiment.scenario.preset,
                     experiment.first_seed,
                     experiment.first_seed + static_cast<std::uint64_t>(experiment.seeds) - 1);
}

std::string ExperimentTable(const SearchExperiment& experiment,
                            const std::vector<VariantSummary>& summaries) {
  std::size_t width = 7;
  for (const SearchVariant& variant : experiment.variants) {
    width = std::max(width, variant.name.size());
  }
  std::string text = fmt::format(
      "SIMULATED operators, {}; means [95 % bootstrap interval]\n"
      "{:{}}  {:8}  {:>9}  {:20}  {:20}  {:20}  {:20}  {:>8}  {:>6}  {:>6}\n",
      MazesText(experiment), "variant", width, "operator", "all goals", "moves", "steps",
      "moves / optimal tour", "pictures", "map right", "p50 ms", "p95 ms");
  for (const VariantSummary& row : summaries) {
    text += fmt::format(
        "{:{}}  {:8}  {:9}  {:20}  {:20}  {:20}  {:20}  {:6.0f} %  {:6.2f}  {:6.2f}\n",
        experiment.variants[row.variant].name, width, experiment.operators[row.person],
        fmt::format("{:>4}/{}", row.all_goals, row.episodes), FigureText(row.moves, 1),
        FigureText(row.steps, 0), row.moves_ratio ? FigureText(*row.moves_ratio, 2) : "-",
        FigureText(row.snapshots, 1), 100.0 * row.mapping_accuracy.mean, row.decision_ms_p50,
        row.decision_ms_p95);
  }
  for (const VariantSummary& row : summaries) {
    const bool has_bars = experiment.variants[row.variant].name == "default" &&
                          experiment.operators[row.person] == "careful";
    if (has_bars) text += BarLine(row);
  }
  return text;
}

nlohmann::ordered_json ExperimentJson(const SearchExperiment& experiment,
                                      const std::vector<VariantSummary>& summaries) {
  nlohmann::ordered_json rows = nlohmann::ordered_json::array();
  for (const VariantSummary& row : summaries) {
    rows.push_back({{"variant", experiment.variants[row.variant].name},
                    {"operator", experiment.operators[row.person]},
                    {"episodes", row.episodes},
                    {"all_goals", row.all_goals},
                    {"goals_share", FigureJson(row.goals_share)},
                    {"moves", FigureJson(row.moves)},
                    {"steps", FigureJson(row.steps)},
                    {"moves_ratio", row.moves_ratio ? FigureJson(*row.moves_ratio) : nullptr},
                    {"pictures", FigureJson(row.snapshots)},
                    {"turning_rad", FigureJson(row.turning_rad)},
                    {"mapping_accuracy", FigureJson(row.mapping_accuracy)},
                    {"decision_ms_p50", row.decision_ms_p50},
                    {"decision_ms_p95", row.decision_ms_p95}});
  }
  return {{"experiment", "search"},
          {"operators", "simulated"},
          {"scenario", experiment.scenario.name},
          {"preset", experiment.scenario.preset},
          {"search", experiment.search},
          {"first_seed", experiment.first_seed},
          {"seeds", experiment.seeds},
          {"rows", std::move(rows)}};
}

std::string ExperimentCsv(const SearchExperiment& experiment,
                          const std::vector<ExperimentEpisode>& episodes) {
  std::string text = fmt::format("variant,{}\n", kEpisodeColumns);
  for (const ExperimentEpisode& episode : episodes) {
    text += fmt::format("{},{}\n", experiment.variants[episode.variant].name,
                        EpisodeCells(experiment, episode));
  }
  return text;
}

}  // namespace conav::planner
