#include "planner/experiment/search_experiment.h"

#include <algorithm>
#include <mutex>

#include "common/runtime/workers.h"
#include "planner/decision/make_method.h"
#include "planner/perception/embedded_perception_model.h"
#include "planner/search/cached_perception_model.h"

namespace conav::planner {
namespace {

constexpr std::uint64_t kSearchSeed = 1;
constexpr std::uint64_t kPersonSeed = 2;

double Percentile(std::vector<double> values, double share) {
  if (values.empty()) return 0.0;
  const auto at = static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + at, values.end());
  return values[static_cast<std::size_t>(at)];
}

EpisodeResult Play(const sim::WorldSpec& world, const SearchVariant& variant,
                   const std::string& person, std::uint64_t seed,
                   const std::shared_ptr<const nhpm::EditModel>& model) {
  const SteadyClock clock;
  const auto method = MakeMethod(
      variant.method, "r1", {variant.config, variant.communication}, DeriveSeed(seed, kSearchSeed),
      std::make_shared<CachedPerceptionModel>(std::make_shared<EmbeddedPerceptionModel>(model)),
      nullptr, clock);
  return RunEpisode(world, *method, operators::ParametersOfKind(person),
                    DeriveSeed(seed, kPersonSeed));
}

Result<std::vector<sim::WorldSpec>> MakeWorlds(const SearchExperiment& experiment) {
  std::vector<sim::WorldSpec> worlds;
  for (int i = 0; i < experiment.seeds; ++i) {
    sim::WorldOptions options;
    options.seed = experiment.first_seed + static_cast<std::uint64_t>(i);
    options.preset = experiment.preset;
    auto world = sim::MakeWorldSpec(options);
    if (!world) return tl::unexpected(world.error());
    worlds.push_back(*std::move(world));
  }
  return worlds;
}

/// Gathers one figure over episodes.
class Figures {
 public:
  void Add(double value) { values_.push_back(value); }
  VariantSummary::Figure Summarize() const { return {Mean(values_), BootstrapMean(values_, 1)}; }

 private:
  std::vector<double> values_;
};

VariantSummary SummarizeOne(std::span<const ExperimentEpisode> episodes) {
  VariantSummary summary;
  summary.variant = episodes.front().variant;
  summary.person = episodes.front().person;
  summary.episodes = static_cast<int>(episodes.size());
  Figures goals, moves, ratio, pictures, turning, accuracy;
  std::vector<double> decisions;
  for (const ExperimentEpisode& episode : episodes) {
    const EpisodeResult& result = episode.result;
    summary.all_goals += result.all_goals ? 1 : 0;
    goals.Add(static_cast<double>(result.goals_reached) / result.goals);
    moves.Add(result.moves);
    if (result.all_goals) ratio.Add(static_cast<double>(result.moves) / result.optimal_moves);
    pictures.Add(result.pictures);
    turning.Add(result.turning_rad);
    accuracy.Add(result.mapping_accuracy);
    decisions.insert(decisions.end(), result.decision_ms.begin(), result.decision_ms.end());
  }
  summary.goals_share = goals.Summarize();
  summary.moves = moves.Summarize();
  if (summary.all_goals > 0) summary.moves_ratio = ratio.Summarize();
  summary.pictures = pictures.Summarize();
  summary.turning_rad = turning.Summarize();
  summary.mapping_accuracy = accuracy.Summarize();
  summary.decision_ms_p50 = Percentile(decisions, 0.5);
  summary.decision_ms_p95 = Percentile(decisions, 0.95);
  return summary;
}

}  // namespace

Result<std::vector<ExperimentEpisode>> RunSearchExperiment(
    const SearchExperiment& experiment, std::shared_ptr<const nhpm::EditModel> model,
    const EpisodeListener& listener) {
  const auto worlds = MakeWorlds(experiment);
  if (!worlds) return tl::unexpected(worlds.error());
  std::vector<ExperimentEpisode> episodes;
  for (std::size_t variant = 0; variant < experiment.variants.size(); ++variant) {
    for (std::size_t person = 0; person < experiment.operators.size(); ++person) {
      for (int i = 0; i < experiment.seeds; ++i) {
        episodes.push_back(
            {variant, person, experiment.first_seed + static_cast<std::uint64_t>(i), {}});
      }
    }
  }
  std::mutex mutex;  // guards done and the listener
  std::size_t done = 0;
  RunOnWorkers(experiment.threads, static_cast<int>(episodes.size()), [&](int, int index) {
    ExperimentEpisode& episode = episodes[static_cast<std::size_t>(index)];
    episode.result =
        Play((*worlds)[episode.seed - experiment.first_seed], experiment.variants[episode.variant],
             experiment.operators[episode.person], episode.seed, model);
    const std::lock_guard lock(mutex);
    if (listener) listener(++done, episodes.size());
  });
  return episodes;
}

std::vector<VariantSummary> Summarize(const std::vector<ExperimentEpisode>& episodes) {
  std::vector<VariantSummary> summaries;
  for (std::size_t first = 0; first < episodes.size();) {
    std::size_t last = first;
    while (last < episodes.size() && episodes[last].variant == episodes[first].variant &&
           episodes[last].person == episodes[first].person) {
      ++last;
    }
    summaries.push_back(SummarizeOne(std::span(episodes).subspan(first, last - first)));
    first = last;
  }
  return summaries;
}

}  // namespace conav::planner
