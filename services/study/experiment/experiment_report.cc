#include "study/experiment/experiment_report.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

namespace conav::planner {
namespace {

std::string WithInterval(const VariantSummary::Figure& figure, int digits) {
  return fmt::format("{:.{}f} [{:.{}f}, {:.{}f}]", figure.mean, digits, figure.interval.low, digits,
                     figure.interval.high, digits);
}

std::string WithInterval(const std::optional<VariantSummary::Figure>& figure, int digits) {
  return figure ? WithInterval(*figure, digits) : "-";
}

nlohmann::ordered_json ToJson(const VariantSummary::Figure& figure) {
  return {{"mean", figure.mean}, {"low", figure.interval.low}, {"high", figure.interval.high}};
}

nlohmann::ordered_json ToJson(const std::optional<VariantSummary::Figure>& figure) {
  return figure ? ToJson(*figure) : nlohmann::ordered_json(nullptr);
}

constexpr double kMostMovesRatio = 1.25;
constexpr double kMostPictures = 14.0;

/// What the default preset has to reach with the careful operator.
std::string BarLine(const VariantSummary& row) {
  const bool arrives = row.all_goals == row.episodes;
  const bool is_short = row.moves_ratio && row.moves_ratio->mean <= kMostMovesRatio;
  const bool is_quiet = row.pictures.mean <= kMostPictures;
  const auto verdict = [](bool met) { return met ? "met" : "MISSED"; };
  return fmt::format(
      "bars of the default with the careful operator: all goals {}; moves / optimal tour at most "
      "{} {}; pictures at most {} {}\n",
      verdict(arrives), kMostMovesRatio, verdict(is_short), kMostPictures, verdict(is_quiet));
}

}  // namespace

std::string ExperimentTable(const SearchExperiment& experiment,
                            const std::vector<VariantSummary>& summaries) {
  std::size_t width = 7;
  for (const SearchVariant& variant : experiment.variants) {
    width = std::max(width, variant.name.size());
  }
  std::string text = fmt::format(
      "SIMULATED operators, mazes {} with seeds {} to {}; means [95 % bootstrap interval]\n"
      "{:{}}  {:8}  {:>9}  {:20}  {:20}  {:20}  {:>12}  {:>6}  {:>6}\n",
      experiment.preset, experiment.first_seed,
      experiment.first_seed + static_cast<std::uint64_t>(experiment.seeds) - 1, "variant", width,
      "operator", "all goals", "moves", "moves / optimal tour", "pictures", "turning, rad",
      "p50 ms", "p95 ms");
  for (const VariantSummary& row : summaries) {
    text += fmt::format(
        "{:{}}  {:8}  {:9}  {:20}  {:20}  {:20}  {:12.1f}  {:6.2f}  {:6.2f}\n",
        experiment.variants[row.variant].name, width, experiment.operators[row.person],
        fmt::format("{:>4}/{}", row.all_goals, row.episodes), WithInterval(row.moves, 1),
        WithInterval(row.moves_ratio, 2), WithInterval(row.pictures, 1), row.turning_rad.mean,
        row.decision_ms_p50, row.decision_ms_p95);
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
                    {"goals_share", ToJson(row.goals_share)},
                    {"moves", ToJson(row.moves)},
                    {"moves_ratio", ToJson(row.moves_ratio)},
                    {"pictures", ToJson(row.pictures)},
                    {"turning_rad", ToJson(row.turning_rad)},
                    {"mapping_accuracy", ToJson(row.mapping_accuracy)},
                    {"decision_ms_p50", row.decision_ms_p50},
                    {"decision_ms_p95", row.decision_ms_p95}});
  }
  return {{"experiment", "search"},      {"operators", "simulated"},
          {"preset", experiment.preset}, {"first_seed", experiment.first_seed},
          {"seeds", experiment.seeds},   {"rows", std::move(rows)}};
}

std::string ExperimentCsv(const SearchExperiment& experiment,
                          const std::vector<ExperimentEpisode>& episodes) {
  std::string text =
      "variant,operator,seed,all_goals,goals_reached,moves,optimal_moves,blocked,pictures,guidance,"
      "edits,mapping_accuracy,turning_rad\n";
  for (const ExperimentEpisode& episode : episodes) {
    const EpisodeResult& r = episode.result;
    text +=
        fmt::format("{},{},{},{},{},{},{},{},{},{},{},{:.6f},{:.6f}\n",
                    experiment.variants[episode.variant].name, experiment.operators[episode.person],
                    episode.seed, r.all_goals ? 1 : 0, r.goals_reached, r.moves, r.optimal_moves,
                    r.blocked, r.pictures, r.guidance, r.edits, r.mapping_accuracy, r.turning_rad);
  }
  return text;
}

}  // namespace conav::planner
