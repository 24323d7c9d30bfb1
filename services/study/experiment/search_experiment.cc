#include "study/experiment/search_experiment.h"

#include <fmt/core.h>

#include <algorithm>
#include <numbers>

#include "common/runtime/config.h"
#include "common/runtime/file.h"
#include "common/runtime/random.h"
#include "common/runtime/result.h"
#include "nhpm/model/load_model.h"
#include "nhpm/model/pooled_model.h"
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

double StepsOf(const SearchVariant& variant, const EpisodeResult& result) {
  if (!result.all_goals) return EstimatedLowLevelSteps(result.action_limit, 0.0);
  if (!variant.steers) return EstimatedLowLevelSteps(result.moves, result.turning_rad);
  constexpr double kStepS = 0.25;
  constexpr double kCellM = 2.0;
  const sim::DriveConfig speeds;
  return (kCellM / speeds.forward_mps * result.moves +
          result.turning_rad * 180.0 / std::numbers::pi / speeds.turn_deg_per_s) /
         kStepS;
}

void SearchVariant::Visit(ConfigReader& reader) {
  std::string kind(Name(method));
  reader.Choice("method", kind,
                {std::string(Name(MethodKind::kIgMcts)), std::string(Name(MethodKind::kGreedy)),
                 std::string(Name(MethodKind::kInstruction))});
  method = ParseMethod(kind).value_or(method);
  reader.Choice("model", model, kPlannersModels);
  reader.Section("glpf", glpf);
  std::string file = weights.string();
  reader.Field("weights", file);
  weights = file;
  if (model == PerceptionModelKind::kGlpf && !file.empty()) {
    reader.Refuse("weights", "model glpf has none");
  }
  reader.Field("true_map", true_map);
  reader.Field("steers", steers);
  reader.Section("communication", communication);
  config.Visit(reader);
}

namespace {

/// Not empty.
YAML::Node VariantsIn(const YAML::Node& document, const std::filesystem::path& file,
                      const std::string& map) {
  const YAML::Node section = document.IsMap() ? document[map] : YAML::Node();
  if (!section || !section.IsMap() || section.size() == 0) {
    throw StartupError(fmt::format("{}: no map {}: {{NAME: {{...}}}}", file.string(), map));
  }
  return section;
}

}  // namespace

std::vector<SearchVariant> ReadSearchVariants(const std::filesystem::path& file,
                                              const std::string& map, const SearchConfig& base) {
  const auto document = ReadYamlFile(file);
  if (!document) throw StartupError(document.error().text);
  std::vector<SearchVariant> variants;
  for (const auto& entry : VariantsIn(*document, file, map)) {
    SearchVariant variant;
    variant.name = entry.first.Scalar();
    variant.config = base;
    ReadConfig(entry.second, file.string() + ": " + variant.name, variant);
    variants.push_back(std::move(variant));
  }
  return variants;
}

std::filesystem::path ShippedVariants() { return ShippedFile("config/search_variants.yaml"); }

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
constexpr double kUsualCells = 13.0 * 13.0;

/// One episode of `scenario`.
class Player {
 public:
  Player(const launcher::Scenario& scenario, const SearchVariant& variant,
         std::shared_ptr<PerceptionModel> model)
      : scenario_(scenario), variant_(variant), model_(std::move(model)) {}

  EpisodeResult Play(const sim::WorldSpec& world, const std::string& kind, std::uint64_t seed) {
    operators::SyntheticOperatorParameters person = operators::ParametersOfKind(kind);
    scenario_.ApplyTo(person);
    if (variant_.true_map) person.planner.horizon = "tour";
    if (variant_.steers) person.glance_rate = 1.0;
    sim::WorldSpec known = world;
    if (variant_.true_map) known.human_map = known.truth;
    EpisodeOptions options = OptionsOf(scenario_, world);
    if (variant_.true_map) options.marked_goals = false;
    options.streams = variant_.method == MethodKind::kInstruction;
    MakeMethods(world.starts.size(), seed);
    EpisodeDriver driver{.methods = {}, .clock = clock_};
    driver.goal_knowledge = variant_.true_map ? GoalKnowledge::kAll : scenario_.goal_knowledge;
    for (const auto& method : methods_) driver.methods.push_back(method.get());
    return RunEpisode(variant_.true_map ? known : world, driver, person, PersonSeed(seed), options);
  }

 private:
  void MakeMethods(std::size_t robots, std::uint64_t seed) {
    std::shared_ptr<PerceptionModel> cached = std::make_shared<CachedPerceptionModel>(model_);
    if (variant_.model == PerceptionModelKind::kAuto) {
      cached = std::make_shared<nhpm::PooledPerceptionModel>(
          cached, std::make_shared<nhpm::Glpf>(nhpm::kGlpfOfTenKinds));
    }
    std::shared_ptr<BeliefEstimate> estimate;
    if (scenario_.x_source != "observed") {
      estimate = std::make_shared<BeliefEstimate>(cached, scenario_.x_source == "none");
    }
    const bool is_timed = variant_.config.options.time_budget_ms > 0.0;
    const Clock& clock = is_timed ? static_cast<const Clock&>(steady_) : clock_;
    for (std::size_t robot = 0; robot < robots; ++robot) {
      const std::uint64_t own = robot == 0 ? seed : DeriveSeed(seed, 1000 + robot);
      methods_.push_back(MakeMethod(variant_.method, {variant_.config, variant_.communication},
                                    DeriveSeed(own, kSearchSeed), cached, estimate, clock));
    }
  }

  const launcher::Scenario& scenario_;
  const SearchVariant& variant_;
  std::shared_ptr<PerceptionModel> model_;
  FakeClock clock_;
  SteadyClock steady_;
  std::vector<std::unique_ptr<Method>> methods_;
};

Result<std::vector<sim::WorldSpec>> MakeWorlds(const SearchExperiment& experiment) {
  std::vector<sim::WorldSpec> worlds;
  const launcher::Scenario& scenario = experiment.scenario;
  for (int i = 0; i < experiment.seeds; ++i) {
    sim::WorldOptions options;
    options.seed = experiment.first_seed + static_cast<std::uint64_t>(i);
    options.robots = scenario.robots;
    scenario.ApplyTo(options);
    auto world = sim::MakeWorldSpec(options);
    if (!world) return tl::unexpected(world.error());
    worlds.push_back(*std::move(world));
  }
  return worlds;
}

/// The model of each variant. Throws StartupError.
std::vector<std::shared_ptr<PerceptionModel>> ModelsOf(
    const SearchExperiment& experiment, const std::shared_ptr<PerceptionModel>& own) {
  std::vector<std::shared_ptr<PerceptionModel>> models;
  for (const SearchVariant& variant : experiment.variants) {
    models.push_back(own);
    if (!variant.model && variant.weights.empty()) continue;
    const auto weights =
        variant.weights.empty() ? variant.weights : ShippedFile("models") / variant.weights;
    auto model = nhpm::LoadPerceptionModel(
        Served(variant.model.value_or(PerceptionModelKind::kNhpm)), weights, variant.glpf);
    if (!model) throw StartupError(model.error().text);
    models.back() = *std::move(model);
  }
  return models;
}

VariantSummary SummarizeOne(const SearchVariant& variant,
                            std::span<const ExperimentEpisode> episodes) {
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
  summary.steps = FigureOf(episodes, [&](const auto& result) { return StepsOf(variant, result); });
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

EpisodeOptions OptionsOf(const launcher::Scenario& scenario, const sim::WorldSpec& world) {
  EpisodeOptions options{.range_cells = scenario.observation_distance_cells};
  const double size = static_cast<double>(world.truth.size()) / kUsualCells;
  options.action_limit = static_cast<int>(options.action_limit * std::max(1.0, size));
  options.marked_goals = scenario.marked_goals;
  return options;
}

std::uint64_t PersonSeed(std::uint64_t seed) { return DeriveSeed(seed, kPersonSeed); }

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
  const auto models = ModelsOf(experiment, model);
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
        Player(experiment.scenario, experiment.variants[episode.variant], models[episode.variant])
            .Play((*worlds)[episode.seed - experiment.first_seed],
                  experiment.operators[episode.person], episode.seed);
    return [] { return false; };
  };
  const auto done = study::RunPieces(all, all.size(), experiment.threads, play, {}, listener);
  if (!done) return tl::unexpected(done.error());
  return episodes;
}

std::vector<VariantSummary> Summarize(const SearchExperiment& experiment,
                                      const std::vector<ExperimentEpisode>& episodes) {
  std::vector<VariantSummary> summaries;
  for (std::size_t first = 0; first < episodes.size();) {
    std::size_t last = first;
    while (last < episodes.size() && episodes[last].variant == episodes[first].variant &&
           episodes[last].person == episodes[first].person) {
      ++last;
    }
    summaries.push_back(SummarizeOne(experiment.variants[episodes[first].variant],
                                     std::span(episodes).subspan(first, last - first)));
    first = last;
  }
  return summaries;
}

}  // namespace conav::planner
