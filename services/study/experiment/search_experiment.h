#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/grid/map_accuracy.h"
#include "common/msg/method.h"
#include "common/msg/perception_model.h"
#include "common/runtime/clock.h"
#include "launcher/scenario.h"
#include "nhpm/model/glpf.h"
#include "operator/simulated/synthetic_operator.h"
#include "planner/decision/method.h"
#include "planner/methods/method_config.h"
#include "sim/world/world_spec.h"
#include "study/experiment/episode.h"
#include "study/piece_runner.h"
#include "study/statistics/moments.h"

namespace conav::planner {

using statistics::Interval;

inline constexpr std::uint64_t kBootstrapSeed = 1;

/// 95 % percentile bootstrap interval of the mean: `draws` resamples of `values` with replacement.
/// Seeded: equal arguments give equal intervals. Of no values {0, 0}.
/// Source: Efron and Tibshirani, An Introduction to the Bootstrap, chapter 13.
Interval BootstrapMean(std::span<const double> values, std::uint64_t seed, int draws = 2000);

/// The middle 95 % of `values`, at least one.
Interval PercentilesOf(std::vector<double> values);

/// A way to set up the search that an experiment compares with others.
struct SearchVariant {
  std::string name;
  SearchConfig config;
  CommunicationConfig communication;
  MethodKind method = MethodKind::kIgMcts;  // kGreedy or kInstruction
  /// Predicts the operator's edits. Neither this nor `weights`: the experiment's model does.
  std::optional<PerceptionModelKind> model;
  nhpm::GlpfParameters glpf;      // of model glpf
  std::filesystem::path weights;  // of a network; relative to the folder of the shipped models
  /// The operator has the true map: with instruction following the shortest tour.
  bool true_map = false;
  /// The person looks at each picture of the stream and steers cell by cell: with instruction following
  /// teleoperation, modelled. Its steps are those of the speeds of sim::DriveConfig.
  bool steers = false;

  /// The keys of a variant.
  void Visit(ConfigReader& reader);
};

/// Low-level steps of an episode under `variant`; without all goals as many as its limit of actions.
double StepsOf(const SearchVariant& variant, const EpisodeResult& result);

/// Reads a YAML map `search_variants: {NAME: {keys of planner.search}, ...}`, in the order of the
/// file; a variant may also have `communication: {keys of planner.communication}`, `method`, `model`, `glpf`,
/// `weights`, `true_map` and `steers`. An empty map is `base`, and other keys change that; `preset` replaces it.
/// `map`: another name than search_variants.
/// Throws StartupError that names the file, the variant, the key and the limit.
std::vector<SearchVariant> ReadSearchVariants(const std::filesystem::path& file,
                                              const std::string& map = "search_variants",
                                              const SearchConfig& base = {});

/// The variants that come with conav.
std::filesystem::path ShippedVariants();

/// The one called `name`. Throws StartupError that names `file` and what there is.
const SearchVariant& FindVariant(const std::vector<SearchVariant>& variants,
                                 const std::string& name, const std::filesystem::path& file);

/// Every variant of the search with every kind of SIMULATED operator in the same mazes of a scenario.
struct SearchExperiment {
  launcher::Scenario scenario;
  std::string search = "default";  // what the variants change, as of SearchFrom; for reports
  std::vector<SearchVariant> variants;
  std::vector<std::string> operators;  // of operators::OperatorKinds()
  int seeds = 100;                     // mazes first_seed, first_seed + 1, ...
  std::uint64_t first_seed = 1;
  int threads = 1;  // changes no result but the times and what time budgets allow
};

/// What a scenario says of an episode, and the seed of the operator in maze `seed`.
EpisodeOptions OptionsOf(const launcher::Scenario& scenario, const sim::WorldSpec& world);
std::uint64_t PersonSeed(std::uint64_t seed);

struct ExperimentEpisode {
  std::size_t variant = 0;
  std::size_t person = 0;  // index into SearchExperiment::operators
  std::uint64_t seed = 0;
  EpisodeResult result;
};

/// A figure over mazes.
struct Figure {
  double mean = 0.0;
  Interval interval;  // BootstrapMean
};

/// Of what `get` gives for the episodes, of which at least one.
Figure FigureOf(std::span<const ExperimentEpisode> episodes,
                const std::function<double(const EpisodeResult&)>& get);

/// "12.3 [11.0, 13.5]".
std::string FigureText(const Figure& figure, int digits);
nlohmann::ordered_json FigureJson(const Figure& figure);  // {mean, low, high}

/// The columns of an episode that tables of all experiments have, and their values.
inline constexpr const char* kEpisodeColumns =
    "operator,seed,all_goals,goals_reached,moves,optimal_moves,blocked,pictures,guidance,edits,"
    "mapping_accuracy,turning_rad";
std::string EpisodeCells(const SearchExperiment& experiment, const ExperimentEpisode& episode);

/// "mazes conav13 with seeds 1 to 100".
std::string MazesText(const SearchExperiment& experiment);

/// One variant with one kind of operator, over all mazes.
struct VariantSummary {
  std::size_t variant = 0;
  std::size_t person = 0;
  int episodes = 0;
  int all_goals = 0;   // episodes that reached all goals
  Figure goals_share;  // goals reached over goals
  Figure moves;
  Figure steps;  // low-level, of all robots
  /// Moves over the optimal tour, of the episodes that reached all goals; nothing without such.
  std::optional<Figure> moves_ratio;
  Figure snapshots;
  Figure turning_rad;  // on the spot, for moves and views
  Figure mapping_accuracy;
  double decision_ms_p50 = 0.0;  // processor time, over all decisions
  double decision_ms_p95 = 0.0;
};

/// All episodes, ordered by variant, operator, seed. `model` predicts the operator's edits for
/// variants that have no other. Throws StartupError for weights that cannot be read.
/// Errors: those of MakeWorldSpec.
[[nodiscard]] Result<std::vector<ExperimentEpisode>> RunSearchExperiment(
    const SearchExperiment& experiment, std::shared_ptr<PerceptionModel> model,
    const study::PieceListener& listener = nullptr);

/// Episodes as they are kept between two runs of a command, without their trajectories and cells.
nlohmann::ordered_json EpisodesJson(const std::vector<ExperimentEpisode>& episodes);
/// Errors: those of ReadFile; kMalformed names the file.
[[nodiscard]] Result<std::vector<ExperimentEpisode>> ReadEpisodes(
    const std::filesystem::path& file);

/// In the order of the episodes.
std::vector<VariantSummary> Summarize(const SearchExperiment& experiment,
                                      const std::vector<ExperimentEpisode>& episodes);

/// A line per variant and kind of operator.
std::string ExperimentTable(const SearchExperiment& experiment,
                            const std::vector<VariantSummary>& summaries);

/// SVG: how much of the operator's map is right at the end against pictures and against steps, a line
/// through the variants, in their order, for each kind of operator.
std::string FrontierPlot(const SearchExperiment& experiment,
                         const std::vector<VariantSummary>& summaries);

/// {"experiment": "search", "operators": "simulated", "scenario", "seeds", ..., "rows": [{"variant",
/// "operator", "all_goals", "episodes", and for goals_share, moves, moves_ratio, pictures,
/// turning_rad, mapping_accuracy: {"mean", "low", "high"}, "decision_ms_p50", "decision_ms_p95"}]}.
/// moves_ratio is null where no episode reached all goals.
nlohmann::ordered_json ExperimentJson(const SearchExperiment& experiment,
                                      const std::vector<VariantSummary>& summaries);

/// A line per episode: variant, then kEpisodeColumns.
std::string ExperimentCsv(const SearchExperiment& experiment,
                          const std::vector<ExperimentEpisode>& episodes);

}  // namespace conav::planner
