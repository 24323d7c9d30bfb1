#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <filesystem>
#include <iterator>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>
#include <vector>

#include "common/cli/batch.h"
#include "common/cli/cli.h"
#include "common/runtime/log.h"
#include "common/runtime/result.h"
#include "common/runtime/text.h"
#include "nhpm/model/load_model.h"
#include "sim/world/maze_presets.h"
#include "study/experiment/scenarios.h"
#include "study/experiment/tradeoff.h"

namespace conav::planner {
namespace {

constexpr const char* kProgram = "conav experiment";

/// The arguments of both experiments.
struct Arguments {
  SearchExperiment experiment;  // without its variants
  PerceptionModelKind model = PerceptionModelKind::kNhpm;
  Batch batch;
  std::filesystem::path weights;
  std::filesystem::path json;
  std::filesystem::path csv;
  std::filesystem::path variants_file = ShippedVariants();
  std::string scenario;  // name; empty: the paper's task with --preset
  std::filesystem::path svg;
  // of search
  std::vector<std::string> chosen;  // names of variants; none = all
  // of scenarios
  std::vector<std::string> scenarios;  // names; none = all
  int robots = 0;                      // 0: as the scenarios say
  // of tradeoff
  std::string variant = "default";
  Effort effort = Effort::kSteps;
  double turn_cost = 0.0;
};

CLI::Validator MazePreset() {
  return {[](const std::string& name) {
            const auto preset = sim::FindMazePreset(name);
            return preset ? "" : preset.error().text;
          },
          ""};
}

std::shared_ptr<PerceptionModel> ModelOf(const Arguments& options) {
  if (options.model == PerceptionModelKind::kGlpf && !options.weights.empty()) {
    throw StartupError(fmt::format("--weights: --model {} has none", Name(options.model)));
  }
  auto model = nhpm::LoadPerceptionModel(options.model, options.weights, {});
  if (!model) throw StartupError("--weights " + model.error().text);
  return *std::move(model);
}

/// Throws StartupError.
SearchConfig SearchOf(const Arguments& options) {
  try {
    return SearchFrom(options.experiment.search);
  } catch (const StartupError& error) {
    throw StartupError(std::string("--search: ") + error.what());
  }
}

/// `operators`: the kinds that play where the user names none.
void AddCommonOptions(CLI::App& app, const std::vector<std::string>& operators,
                      Arguments& options) {
  SearchExperiment& experiment = options.experiment;
  experiment.operators = operators;
  app.add_option("--operators", experiment.operators, "Kinds of simulated operators")
      ->delimiter(',')
      ->check(CLI::IsMember(operators::OperatorKinds()))
      ->capture_default_str();
  AddNumber(app, "--seeds", experiment.seeds, "How many mazes", 1, 100000);
  AddSeed(app, "--first-seed", experiment.first_seed, "Seed of the first maze");
  AddShown(app, "--search", experiment.search,
           "What variants and methods change, as of conav demo --search: a preset, or a YAML "
           "file with search: {keys of planner.search}");
  AddChoice(app, "--model", options.model, kPerceptionModels,
            "Model that predicts the operator's edits");
  app.add_option("--weights", options.weights, "Of nhpm (the ones that come with conav)");
  experiment.threads = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  app.add_option("--jobs", experiment.threads,
                 "Episodes at once [one per core]; changes no result but the times, and what a "
                 "variant with "
                 "a time budget gets done in it")
      ->check(Between(1, 256));
  app.add_option("--json", options.json, "Write the summary to this file");
  app.add_option("--csv", options.csv, "Write a line per episode to this file");
  options.batch.AddOptions(app, "mazes");
}

/// Of experiments in one task.
void AddTaskOptions(CLI::App& command, Arguments& arguments) {
  auto* preset = command
                     .add_option("--preset", arguments.experiment.scenario.preset,
                                 "Of the mazes; ./conav maze --help lists them")
                     ->check(MazePreset())
                     ->capture_default_str();
  command
      .add_option("--scenario", arguments.scenario,
                  "The task, by its name in deploy/config/scenarios.yaml (the paper's)")
      ->excludes(preset);
  command.add_option("--svg", arguments.svg, "Draw the results into this file");
}

SearchExperiment TaskOf(const Arguments& arguments) {
  SearchExperiment experiment = arguments.experiment;
  if (!arguments.scenario.empty()) experiment.scenario = launcher::FindScenario(arguments.scenario);
  return experiment;
}

void AddTradeoffCommand(CLI::App& app, Arguments& arguments) {
  const std::map<std::string, Effort> efforts{{"steps", Effort::kSteps}, {"moves", Effort::kMoves}};
  CLI::App* command = app.add_subcommand(
      "tradeoff",
      "Plays IG-MCTS over costs of a picture, and every other communication policy over its "
      "parameter, in the same mazes with simulated operators; prints pictures against steps and "
      "where IG-MCTS needs fewer steps at equal pictures or fewer pictures at equal steps.");
  AddCommonOptions(*command, {"careful", "hasty"}, arguments);
  command->add_option("--variants-file", arguments.variants_file,
                      "Variants of the search, as of the subcommand search");
  AddShown(*command, "--variant", arguments.variant,
           "The search in which all policies play, by its name in that file");
  command
      ->add_option("--against", arguments.effort,
                   "Weigh pictures against low-level control steps (estimated from moves "
                   "and turning) or cell moves")
      ->transform(CLI::CheckedTransformer(efforts))
      ->default_str("steps");
  AddNumber(*command, "--turn-cost", arguments.turn_cost,
            "Expected edits that a radian of turning outweighs when the other policies choose "
            "a heading; 0: they send the most informative view",
            0.0, 1e6);
  AddTaskOptions(*command, arguments);
}

void AddSearchCommand(CLI::App& app, Arguments& arguments) {
  CLI::App* command = app.add_subcommand(
      "search",
      "Plays every variant of the search with every kind of simulated operator in the same mazes, "
      "in one process without bus and physics, and prints goals reached, moves, pictures and times "
      "with bootstrap intervals.");
  command->add_option(
      "--variants-file", arguments.variants_file,
      "YAML: search_variants: {NAME: {keys of planner.search, communication: {keys of "
      "planner.communication}, method: ig-mcts or greedy}} (the variants that come with "
      "conav)");
  command->add_option("--variants", arguments.chosen, "Only these, by name (all of the file)")
      ->delimiter(',');
  AddCommonOptions(*command, operators::OperatorKinds(), arguments);
  AddTaskOptions(*command, arguments);
}

void AddScenariosCommand(CLI::App& app, Arguments& arguments) {
  CLI::App* command = app.add_subcommand(
      "scenarios",
      "Plays every method in every scenario of deploy/config/scenarios.yaml, in one process "
      "without bus "
      "and physics, and says where the person matters (IG-MCTS against greedy, never sending and "
      "rules) and where NHPM beats GLPF in the same search.");
  command->add_option("--scenarios", arguments.scenarios, "Only these, by name (all of the file)")
      ->delimiter(',');
  command->add_option("--robots", arguments.robots, "So many, whatever the scenarios say")
      ->check(Between(1, 16));
  command->add_option("--methods", arguments.chosen, "Only these besides those that are compared")
      ->delimiter(',');
  AddCommonOptions(*command, operators::OperatorKinds(), arguments);
}

/// Texts for standard output and files. Empty files are not written.
struct Report {
  std::string table;
  nlohmann::ordered_json json;
  std::string csv;
  std::string svg;
};

SearchExperiment MazeOf(SearchExperiment experiment, int maze) {
  experiment.first_seed += static_cast<std::uint64_t>(maze);
  experiment.seeds = 1;
  return experiment;
}

/// The episodes of one maze, from its record or played now. Errors: those of RunSearchExperiment and
/// ReadEpisodes.
Result<std::vector<ExperimentEpisode>> PlayMaze(const SearchExperiment& experiment,
                                                const std::shared_ptr<PerceptionModel>& model,
                                                const std::filesystem::path& record) {
  if (std::filesystem::exists(record)) return ReadEpisodes(record);
  return RunSearchExperiment(experiment, model).and_then([&](auto&& episodes) {
    return WriteJsonFile(record, EpisodesJson(episodes)).map([&] { return std::move(episodes); });
  });
}

/// The mazes one by one, each with its record.
Result<std::vector<ExperimentEpisode>> PlayMazes(const SearchExperiment& experiment,
                                                 const Arguments& arguments,
                                                 std::size_t first_piece) {
  const auto model = ModelOf(arguments);
  ProgressLine line;
  std::vector<ExperimentEpisode> all;
  for (int maze = 0; maze < experiment.seeds; ++maze) {
    const auto piece = first_piece + static_cast<std::size_t>(maze);
    auto episodes =
        PlayMaze(MazeOf(experiment, maze), model, arguments.batch.FileOf(piece, ".json"));
    if (!episodes) return episodes;
    std::ranges::move(*episodes, std::back_inserter(all));
    line.ShowNowAndThen(fmt::format("{} of {} mazes", maze + 1, experiment.seeds));
  }
  std::ranges::stable_sort(all, {}, [](const ExperimentEpisode& episode) {
    return std::pair(episode.variant, episode.person);
  });
  return all;
}

/// With a progress line. `number`: of the experiment, where there are several. Errors: those of
/// RunSearchExperiment. Throws StartupError without model.
Result<std::vector<ExperimentEpisode>> Play(const SearchExperiment& experiment,
                                            const Arguments& arguments, std::size_t number = 0) {
  const auto mazes = static_cast<std::size_t>(experiment.seeds);
  if (arguments.batch.is_kept()) return PlayMazes(experiment, arguments, number * mazes);
  const auto model = ModelOf(arguments);
  ProgressLine line;
  return RunSearchExperiment(experiment, model,
                             study::ShowOn(line, "episodes", study::ProgressPace::kNowAndThen));
}

std::vector<SearchVariant> VariantsOf(const Arguments& arguments) {
  return ReadSearchVariants(arguments.variants_file, "search_variants", SearchOf(arguments));
}

TradeoffSweep SweepOf(const Arguments& arguments) {
  const auto all = VariantsOf(arguments);
  const SearchVariant& search = FindVariant(all, arguments.variant, arguments.variants_file);
  TradeoffSweep sweep = MakeTradeoffSweep(search.config, TaskOf(arguments), arguments.turn_cost);
  sweep.effort = arguments.effort;
  return sweep;
}

Result<Report> RunTradeoff(const Arguments& arguments) {
  const TradeoffSweep sweep = SweepOf(arguments);
  return Play(sweep.experiment, arguments).map([&](const auto& episodes) -> Report {
    const auto rows = AnalyseTradeoff(sweep, episodes);
    return {TradeoffTable(sweep, rows), TradeoffJson(sweep, rows), TradeoffCsv(sweep, episodes),
            TradeoffPlot(sweep, rows)};
  });
}

SearchExperiment ComparisonOf(const Arguments& arguments) {
  SearchExperiment experiment = TaskOf(arguments);
  const auto all = VariantsOf(arguments);
  if (arguments.chosen.empty()) experiment.variants = all;
  for (const std::string& name : arguments.chosen) {
    experiment.variants.push_back(FindVariant(all, name, arguments.variants_file));
  }
  return experiment;
}

Result<Report> RunSearch(const Arguments& arguments) {
  const SearchExperiment experiment = ComparisonOf(arguments);
  return Play(experiment, arguments).map([&](const auto& episodes) -> Report {
    const auto summaries = Summarize(experiment, episodes);
    return {ExperimentTable(experiment, summaries), ExperimentJson(experiment, summaries),
            ExperimentCsv(experiment, episodes), FrontierPlot(experiment, summaries)};
  });
}

constexpr std::array kCompared{"ig-mcts", "ig-mcts-glpf", "greedy", "never"};

/// One for each scenario.
std::vector<SearchExperiment> ScenarioExperimentsOf(const Arguments& arguments) {
  const std::filesystem::path file = launcher::ShippedScenarios();
  std::vector<SearchVariant> methods = ReadSearchVariants(file, "methods", SearchOf(arguments));
  for (const std::string& name : arguments.chosen) FindVariant(methods, name, file);
  std::erase_if(methods, [&](const SearchVariant& method) {
    return !arguments.chosen.empty() && std::ranges::count(arguments.chosen, method.name) == 0 &&
           std::ranges::count(kCompared, method.name) == 0;
  });
  std::vector<launcher::Scenario> scenarios;
  for (const std::string& name : arguments.scenarios) {
    scenarios.push_back(launcher::FindScenario(name));
  }
  if (scenarios.empty()) scenarios = launcher::ReadScenarios(file);
  std::vector<SearchExperiment> experiments;
  for (launcher::Scenario& scenario : scenarios) {
    SearchExperiment& experiment = experiments.emplace_back(arguments.experiment);
    experiment.variants = methods;
    experiment.scenario = std::move(scenario);
    if (arguments.robots > 0) experiment.scenario.robots = arguments.robots;
  }
  return experiments;
}

Result<Report> RunScenarios(const Arguments& arguments) {
  Report report;
  std::vector<ScenarioResult> results;
  for (SearchExperiment& experiment : ScenarioExperimentsOf(arguments)) {
    auto episodes = Play(experiment, arguments, results.size());
    if (!episodes) return tl::unexpected(episodes.error());
    results.push_back({std::move(experiment), *std::move(episodes)});
    report.table += ScenarioTable(results.back());
  }
  report.json = ScenariosJson(results);
  report.csv = ScenariosCsv(results);
  return report;
}

/// Starts what is done maze by maze: --records, --slurm. The exit code of a job of a Slurm array.
std::optional<int> StartPieces(const Arguments& arguments, const std::string& name) {
  const auto experiments = name == "scenarios"  ? ScenarioExperimentsOf(arguments)
                           : name == "tradeoff" ? std::vector{SweepOf(arguments).experiment}
                                                : std::vector{ComparisonOf(arguments)};
  const auto mazes = static_cast<std::size_t>(arguments.experiment.seeds);
  arguments.batch.Start(experiments.size() * mazes);
  const auto& piece = arguments.batch.piece();
  if (!piece) return std::nullopt;
  const SearchExperiment maze =
      MazeOf(experiments.at(*piece / mazes), static_cast<int>(*piece % mazes));
  const auto played = PlayMaze(maze, ModelOf(arguments), arguments.batch.FileOf(*piece, ".json"));
  return ExitCode(kProgram, played.map([](const auto&) {}));
}

/// The exit code. Throws StartupError.
int Run(const Arguments& arguments, const std::string& name) {
  const int code = CheckFiles(
      kProgram, {{"--variants-file", arguments.variants_file}, {"--weights", arguments.weights}},
      {{"--json", arguments.json}, {"--csv", arguments.csv}, {"--svg", arguments.svg}});
  if (code != 0) return code;
  if (const auto ended = StartPieces(arguments, name)) return *ended;
  const auto report = name == "scenarios"  ? RunScenarios(arguments)
                      : name == "tradeoff" ? RunTradeoff(arguments)
                                           : RunSearch(arguments);
  if (!report) return Failed(kProgram, report.error());
  return ExitCode(kProgram,
                  WriteStandardOutput(report->table)
                      .and_then([&] { return WriteOutput(arguments.csv, report->csv); })
                      .and_then([&] { return WriteOutput(arguments.svg, report->svg); })
                      .and_then([&] { return WriteJsonOutput(arguments.json, report->json); }));
}

}  // namespace
}  // namespace conav::planner

// conav-experiment: compares variants of the search, and communication policies, over many mazes.

int main(int argc, char** argv) {
  using namespace conav::planner;
  CLI::App app("Experiments with the planner, with SIMULATED operators.", "conav experiment");
  app.require_subcommand(1);
  Arguments search_arguments;
  Arguments tradeoff_arguments;
  Arguments scenario_arguments;
  scenario_arguments.experiment.first_seed = 1001;
  AddSearchCommand(app, search_arguments);
  AddTradeoffCommand(app, tradeoff_arguments);
  AddScenariosCommand(app, scenario_arguments);
  if (conav::NamesUnknownCommand(app, argc, argv)) {
    return conav::Refused(
        kProgram,
        fmt::format("there is no experiment '{}'; there are search, tradeoff and scenarios",
                    argv[1]));
  }
  if (const auto ended = conav::Parse(app, argc, argv)) return *ended;
  try {
    conav::log::SetMinimumLevel(conav::log::Level::kError);  // a silent operator is no news here
    const std::string name = app.get_subcommands().front()->get_name();
    return Run(name == "search"     ? search_arguments
               : name == "tradeoff" ? tradeoff_arguments
                                    : scenario_arguments,
               name);
  } catch (const conav::StartupError& error) {
    return conav::Refused(kProgram, error.what());
  }
}
