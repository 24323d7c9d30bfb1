#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/msg/method.h"
#include "common/msg/perception_model.h"
#include "planner/methods/method_config.h"
#include "study/experiment/episode.h"

namespace conav::planner {

struct Interval {
  double low = 0.0;
  double high = 0.0;
};

/// 95 % percentile bootstrap interval of the mean: `draws` resamples of `values` with replacement.
/// Seeded: equal arguments give equal intervals. Of no values {0, 0}.
/// Source: Efron and Tibshirani, An Introduction to the Bootstrap, chapter 13.
Interval BootstrapMean(std::span<const double> values, std::uint64_t seed, int draws = 2000);

double Mean(std::span<const double> values);  // 0 of none

/// A way to set up the search that an experiment compares with others.
struct SearchVariant {
  std::string name;
  SearchConfig config;
  CommunicationConfig communication;
  MethodKind method = MethodKind::kIgMcts;  // or kGreedy
};

/// Reads a YAML map `search_variants: {NAME: {keys of planner.search}, ...}`, in the order of the
/// file; beside them a variant may have `communication: {keys of planner.communication}` and
/// `method`. An empty map is the default preset.
/// Throws StartupError that names the file, the variant, the key and the limit.
std::vector<SearchVariant> ReadSearchVariants(const std::filesystem::path& file);

/// The variants that come with conav.
std::filesystem::path ShippedVariants();

/// The one called `name`. Throws StartupError that names `file` and what there is.
const SearchVariant& FindVariant(const std::vector<SearchVariant>& variants,
                                 const std::string& name, const std::filesystem::path& file);

/// Every variant of the search with every kind of SIMULATED operator in the same mazes.
struct SearchExperiment {
  std::vector<SearchVariant> variants;
  std::vector<std::string> operators;  // of operators::OperatorKinds()
  int seeds = 100;                     // mazes first_seed, first_seed + 1, ...
  std::uint64_t first_seed = 1;
  std::string preset = "conav13";  // of the mazes
  int threads = 1;                 // changes no result but the times and what time budgets allow
};

struct ExperimentEpisode {
  std::size_t variant = 0;
  std::size_t person = 0;  // index into SearchExperiment::operators
  std::uint64_t seed = 0;
  EpisodeResult result;
};

/// One variant with one kind of operator, over all mazes.
struct VariantSummary {
  std::size_t variant = 0;
  std::size_t person = 0;
  int episodes = 0;
  int all_goals = 0;  // episodes that reached all goals
  struct Figure {
    double mean = 0.0;
    Interval interval;  // BootstrapMean
  };
  Figure goals_share;  // goals reached over goals
  Figure moves;
  /// Moves over the optimal tour, of the episodes that reached all goals; nothing without such.
  std::optional<Figure> moves_ratio;
  Figure pictures;
  Figure turning_rad;  // on the spot, for moves and views
  Figure mapping_accuracy;
  double decision_ms_p50 = 0.0;  // processor time, over all decisions
  double decision_ms_p95 = 0.0;
};

/// Called after each episode, never by two threads at once.
using EpisodeListener = std::function<void(std::size_t done, std::size_t of)>;

/// All episodes, ordered by variant, operator, seed. `model` predicts the operator's edits for all.
/// Errors: those of MakeWorldSpec.
[[nodiscard]] Result<std::vector<ExperimentEpisode>> RunSearchExperiment(
    const SearchExperiment& experiment, std::shared_ptr<PerceptionModel> model,
    const EpisodeListener& listener = nullptr);

/// In the order of the episodes.
std::vector<VariantSummary> Summarize(const std::vector<ExperimentEpisode>& episodes);

}  // namespace conav::planner
