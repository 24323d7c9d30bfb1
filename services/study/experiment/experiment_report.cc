#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <vector>

#include "common/plot/axes.h"
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
          {"preset", experiment.scenario.preset},
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

namespace {

constexpr double kFrontierPanel = 400.0;  // of the axes, both
constexpr double kFrontierLeft = 56.0;
constexpr double kFrontierTop = 24.0;
constexpr double kFrontierBetween = 64.0;
constexpr int kFrontierTicks = 6;
// Okabe and Ito's colours, which people with any colour vision tell apart.
constexpr const char* kColors[]{"#000000", "#d55e00", "#0072b2", "#009e73"};

using Rows = std::vector<const VariantSummary*>;

/// The right share of the operator's map against `cost`, a line through the variants per operator.
void DrawFrontier(SvgCanvas& canvas, double left, const SearchExperiment& experiment,
                  const std::vector<Rows>& people, Figure VariantSummary::*cost,
                  const char* label) {
  double least = 1e9;
  double most = 0.0;
  for (const Rows& rows : people) {
    for (const VariantSummary* row : rows) {
      least = std::min(least, (row->*cost).mean);
      most = std::max(most, (row->*cost).mean);
    }
  }
  const PlotArea area{{left, kFrontierTop},
                      kFrontierPanel,
                      kFrontierPanel,
                      RoundAxis(least, most, kFrontierTicks, {.least = 0.0}),
                      RoundAxis(0.0, 100.0, kFrontierTicks),
                      kDocumentPlotStyle};
  area.Draw(canvas, label, "right cells of the operator's map, %");
  for (std::size_t person = 0; person < people.size(); ++person) {
    const char* color = kColors[person % std::size(kColors)];
    std::vector<PixelPosition> line;
    for (const VariantSummary* row : people[person]) {
      const PixelPosition at =
          line.emplace_back(area.At((row->*cost).mean, 100.0 * row->mapping_accuracy.mean));
      canvas.Circle(at, 3.5, fmt::format("fill=\"{}\"", color));
      if (person == 0) {
        canvas.Text({at.x + 6, at.y + 12}, experiment.variants[row->variant].name,
                    "font-size=\"9\" fill=\"#444444\"");
      }
    }
    canvas.Polyline(line, fmt::format("stroke=\"{}\" stroke-width=\"1.5\"", color));
  }
}

}  // namespace

std::string FrontierPlot(const SearchExperiment& experiment,
                         const std::vector<VariantSummary>& summaries) {
  std::vector<Rows> people(experiment.operators.size());
  for (const VariantSummary& row : summaries) people[row.person].push_back(&row);
  SvgCanvas canvas;
  DrawFrontier(canvas, kFrontierLeft, experiment, people, &VariantSummary::snapshots,
               "pictures per episode (180 KiB each)");
  DrawFrontier(canvas, kFrontierLeft + kFrontierPanel + kFrontierBetween, experiment, people,
               &VariantSummary::steps, "low-level steps");
  const double below = kFrontierTop + kFrontierPanel + 64;
  for (std::size_t person = 0; person < people.size(); ++person) {
    const double x = kFrontierLeft + 160.0 * static_cast<double>(person);
    canvas.Circle({x, below}, 3.5,
                  fmt::format("fill=\"{}\"", kColors[person % std::size(kColors)]));
    canvas.Text({x + 10, below + 4}, "simulated: " + experiment.operators[person],
                "font-size=\"12\"");
  }
  return canvas.Document(kFrontierLeft + 2 * kFrontierPanel + kFrontierBetween + 110, below + 24,
                         "The operator's map against pictures and steps for each variant");
}

}  // namespace conav::planner
