#include "study/experiment/search_experiment.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>

#include "common/runtime/config.h"
#include "common/runtime/random.h"
#include "common/runtime/result.h"
#include "nhpm/model/load_model.h"
#include "planner/methods/make_method.h"
#include "planner/perception/cached_model.h"

namespace conav::planner {
namespace {

/// `sorted` is not empty.
double Percentile(const std::vector<double>& sorted, double share) {
  return sorted[static_cast<std::size_t>(share * static_cast<double>(sorted.size() - 1))];
}

}  // namespace

Interval BootstrapMean(std::span<const double> values, std::uint64_t seed, int draws) {
  if (values.empty()) return {};
  Random random(seed);
  const auto last = static_cast<std::int64_t>(values.size()) - 1;
  std::vector<double> means;
  for (int draw = 0; draw < draws; ++draw) {
    double sum = 0.0;
    for (std::size_t i = 0; i < values.size(); ++i) {
      sum += values[static_cast<std::size_t>(random.Uniform(0, last))];
    }
    means.push_back(sum / static_cast<double>(values.size()));
  }
  return PercentilesOf(std::move(means));
}

Interval PercentilesOf(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return {Percentile(values, 0.025), Percentile(values, 0.975)};
}

void SearchVariant::Visit(ConfigReader& reader) {
  std::string kind(Name(method));
  reader.Choice("method", kind,
                {std::string(Name(MethodKind::kIgMcts)), std::string(Name(MethodKind::kGreedy))});
  method = ParseMethod(kind).value_or(method);
  reader.Section("communication", communication);
  config.Visit(reader);
}

namespace {

/// Not empty.
YAML::Node VariantsIn(const YAML::Node& document, const std::filesystem::path& file) {
  const YAML::Node section = document.IsMap() ? document["search_variants"] : YAML::Node();
  if (!section || !section.IsMap() || section.size() == 0) {
    throw StartupError(file.string() + ": no map search_variants: {NAME: {...}}");
  }
  return section;
}

}  // namespace

std::vector<SearchVariant> ReadSearchVariants(const std::filesystem::path& file) {
  const auto document = ReadYamlFile(file);
  if (!document) throw StartupError(document.error().text);
  std::vector<SearchVariant> variants;
  for (const auto& entry : VariantsIn(*document, file)) {
    SearchVariant variant;
    variant.name = entry.first.Scalar();
    ReadConfig(entry.second, file.string() + ": " + variant.name, variant);
    variants.push_back(std::move(variant));
  }
  return variants;
}

std::filesystem::path ShippedVariants() {
  return nhpm::ShippedWeights().parent_path().parent_path() / "config" / "search_variants.yaml";
}

const SearchVariant& FindVariant(const std::vector<SearchVariant>& variants,
                                 const std::string& name, const std::filesystem::path& file) {
  const auto found = std::find_if(variants.begin(), variants.end(),
                                  [&](const SearchVariant& v) { return v.name == name; });
  if (found != variants.end()) return *found;
  std::string names;
  for (const SearchVariant& variant : variants) names += " " + variant.name;
  throw StartupError(fmt::format("no variant {} in {}; there are{}", name, file.string(), names));
}

namespace {

constexpr std::uint64_t kSearchSeed = 1;
constexpr std::uint64_t kPersonSeed = 2;

EpisodeResult Play(const sim::WorldSpec& world, const SearchVariant& variant,
                   const std::string& person, std::uint64_t seed,
                   const std::shared_ptr<PerceptionModel>& model) {
  const SteadyClock clock;
  const auto method = MakeMethod(variant.method, {variant.config, variant.communication},
                                 DeriveSeed(seed, kSearchSeed),
                                 std::make_shared<CachedPerceptionModel>(model), nullptr, clock);
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

VariantSummary SummarizeOne(std::span<const ExperimentEpisode> episodes) {
  VariantSummary summary;
  summary.variant = episodes.front().variant;
  summary.person = episodes.front().person;
  summary.episodes = static_cast<int>(episodes.size());
  std::vector<double> decisions;
  std::vector<ExperimentEpisode> arrived;
  for (const ExperimentEpisode& episode : episodes) {
    const EpisodeResult& result = episode.result;
    if (result.all_goals) arrived.push_back(episode);
    decisions.insert(decisions.end(), result.decision_ms.begin(), result.decision_ms.end());
  }
  summary.all_goals = static_cast<int>(arrived.size());
  summary.goals_share = FigureOf(episodes, [](const EpisodeResult& result) {
    return static_cast<double>(result.goals_reached) / result.goals;
  });
  if (!arrived.empty()) {
    summary.moves_ratio = FigureOf(arrived, [](const EpisodeResult& result) {
      return static_cast<double>(result.moves) / result.optimal_moves;
    });
  }
  summary.moves = FigureOf(episodes, &EpisodeResult::moves);
  summary.snapshots = FigureOf(episodes, &EpisodeResult::snapshots);
  summary.turning_rad = FigureOf(episodes, &EpisodeResult::turning_rad);
  summary.mapping_accuracy = FigureOf(episodes, &EpisodeResult::mapping_accuracy);
  std::sort(decisions.begin(), decisions.end());
  if (decisions.empty()) return summary;
  summary.decision_ms_p50 = Percentile(decisions, 0.5);
  summary.decision_ms_p95 = Percentile(decisions, 0.95);
  return summary;
}

}  // namespace

Figure FigureOf(std::span<const ExperimentEpisode> episodes,
                const std::function<double(const EpisodeResult&)>& get) {
  std::vector<double> values;
  for (const ExperimentEpisode& episode : episodes) values.push_back(get(episode.result));
  return {statistics::Mean(values), BootstrapMean(values, kBootstrapSeed)};
}

Result<std::vector<ExperimentEpisode>> RunSearchExperiment(const SearchExperiment& experiment,
                                                           std::shared_ptr<PerceptionModel> model,
                                                           const study::PieceListener& listener) {
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
  std::vector<std::size_t> all(episodes.size());
  std::iota(all.begin(), all.end(), std::size_t{0});
  const study::PlayPiece play = [&](int, std::size_t index) -> study::StorePiece {
    ExperimentEpisode& episode = episodes[index];
    episode.result =
        Play((*worlds)[episode.seed - experiment.first_seed], experiment.variants[episode.variant],
             experiment.operators[episode.person], episode.seed, model);
    return [] { return false; };
  };
  const auto done = study::RunPieces(all, all.size(), experiment.threads, play, {}, listener);
  if (!done) return tl::unexpected(done.error());
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
