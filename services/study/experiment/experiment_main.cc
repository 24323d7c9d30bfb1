#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>
#include <vector>

#include "common/cli/cli.h"
#include "common/cli/progress_line.h"
#include "common/runtime/result.h"
#include "nhpm/model/load_model.h"
#include "sim/world/maze_presets.h"
#include "study/experiment/experiment_report.h"
#include "study/experiment/search_experiment.h"
#include "study/experiment/tradeoff.h"

namespace conav::planner {
namespace {

inline constexpr const char* kProgram = "conav experiment";

/// What every experiment is asked for.
struct ExperimentOptions {
  SearchExperiment experiment;  // but for its variants
  std::string model = kDefaultPerceptionModel;
  std::filesystem::path weights;
  std::filesystem::path json;
  std::filesystem::path csv;
};

/// "120 of 400 episodes, 1:12 left".
EpisodeListener Progress(ProgressLine& line) {
  const auto start = std::chrono::steady_clock::now();
  return [&line, start](std::size_t done, std::size_t of) {
    const double spent =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    const double left = spent / static_cast<double>(done) * static_cast<double>(of - done);
    line.ShowNowAndThen(fmt::format("{} of {} episodes, {} left", done, of, DurationText(left)));
  };
}

CLI::Validator MazePreset() {
  return {[](const std::string& name) {
            const auto preset = sim::FindMazePreset(name);
            return preset ? "" : preset.error().text;
          },
          ""};
}

std::shared_ptr<PerceptionModel> ModelOf(const ExperimentOptions& options) {
  if (options.model == kGlpfModel && !options.weights.empty()) {
    throw StartupError("--weights: --model glpf has none");
  }
  auto model = nhpm::LoadPerceptionModel(options.model, options.weights, {});
  if (!model) throw StartupError("--weights " + model.error().text);
  return *std::move(model);
}

/// `operators`: the kinds that play where the user names none.
void AddExperimentOptions(CLI::App& app, const std::vector<std::string>& operators,
                          ExperimentOptions& options) {
  SearchExperiment& experiment = options.experiment;
  experiment.operators = operators;
  app.add_option("--operators", experiment.operators, "Kinds of simulated operators")
      ->delimiter(',')
      ->check(CLI::IsMember(operators::OperatorKinds()))
      ->capture_default_str();
  app.add_option("--seeds", experiment.seeds, "How many mazes")
      ->check(CLI::Range(1, 100000))
      ->capture_default_str();
  app.add_option("--first-seed", experiment.first_seed, "Seed of the first maze")
      ->check(WholeNumber())
      ->capture_default_str();
  app.add_option("--preset", experiment.preset, "Of the mazes; ./conav maze --help lists them")
      ->check(MazePreset())
      ->capture_default_str();
  app.add_option("--model", options.model, "Who predicts the operator's edits")
      ->check(CLI::IsMember({"nhpm", "glpf"}))
      ->capture_default_str();
  app.add_option("--weights", options.weights, "Of nhpm (the ones that come with conav)");
  experiment.threads = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  app.add_option("--jobs", experiment.threads,
                 "Episodes at once [one per core]; changes no result but the times, and what a "
                 "variant with "
                 "a time budget gets done in it")
      ->check(CLI::Range(1, 256));
  app.add_option("--json", options.json, "Write the summary to this file");
  app.add_option("--csv", options.csv, "Write a line per episode to this file");
}

/// Plays `experiment`, with a progress line. Errors: those of RunSearchExperiment. Throws
/// StartupError when there is no such model.
Result<std::vector<ExperimentEpisode>> PlayExperiment(const SearchExperiment& experiment,
                                                      const ExperimentOptions& options) {
  const auto model = ModelOf(options);
  ProgressLine line;
  return RunSearchExperiment(experiment, model, Progress(line));
}

struct TradeoffArguments {
  ExperimentOptions options;
  std::filesystem::path svg;
  std::filesystem::path variants_file = ShippedVariants();
  std::string variant = "default";
  Effort effort = Effort::kSteps;
  double turn_cost = 0.0;
};

const std::map<std::string, Effort> efforts{{"steps", Effort::kSteps}, {"moves", Effort::kMoves}};

/// Adds the subcommand that RunTradeoff() carries out.
CLI::App* AddTradeoffCommand(CLI::App& app, TradeoffArguments& arguments) {
  CLI::App* command = app.add_subcommand(
      "tradeoff",
      "Plays IG-MCTS over costs of a picture, and every other communication policy over its "
      "parameter, in the same mazes with simulated operators; prints pictures against steps and "
      "where IG-MCTS needs fewer steps at equal pictures or fewer pictures at equal steps.");
  AddExperimentOptions(*command, {"careful", "hasty"}, arguments.options);
  command->add_option("--variants-file", arguments.variants_file,
                      "Variants of the search, as of the subcommand search");
  command
      ->add_option("--variant", arguments.variant,
                   "The search in which all policies play, by its name in that file")
      ->capture_default_str();
  command
      ->add_option(
          "--against", arguments.effort,
          "What pictures are weighed against: low-level control steps (estimated from moves "
          "and turning) or cell moves")
      ->transform(CLI::CheckedTransformer(efforts))
      ->default_str("steps");
  command
      ->add_option(
          "--turn-cost", arguments.turn_cost,
          "Expected edits that a radian of turning outweighs when the other policies choose "
          "a heading; 0: they send the most informative view")
      ->check(CLI::Range(0.0, 1e6))
      ->capture_default_str();
  command->add_option("--svg", arguments.svg, "Draw the curves into this file");
  return command;
}

/// The exit code. Throws StartupError.
int RunTradeoff(const TradeoffArguments& arguments) {
  const ExperimentOptions& options = arguments.options;
  const int code = CheckFiles(
      kProgram, {{"--variants-file", arguments.variants_file}, {"--weights", options.weights}},
      {{"--json", options.json}, {"--csv", options.csv}, {"--svg", arguments.svg}});
  if (code != 0) return code;
  const SearchVariant search = FindVariant(ReadSearchVariants(arguments.variants_file),
                                           arguments.variant, arguments.variants_file);
  TradeoffSweep sweep = MakeTradeoffSweep(search.config, options.experiment, arguments.turn_cost);
  sweep.effort = arguments.effort;
  const auto episodes = PlayExperiment(sweep.experiment, options);
  if (!episodes) return Failed(kProgram, episodes.error());
  const auto rows = AnalyseTradeoff(sweep, *episodes);
  auto done = WriteStandardOutput(TradeoffTable(sweep, rows));
  if (done) done = WriteOutput(options.csv, TradeoffCsv(sweep, *episodes));
  if (done) done = WriteOutput(arguments.svg, TradeoffPlot(sweep, rows));
  if (done && !options.json.empty()) {
    done = WriteJsonOutput(options.json, TradeoffJson(sweep, rows));
  }
  return ExitCode(kProgram, done);
}

}  // namespace
}  // namespace conav::planner

// conav-experiment: compares variants of the search, and communication policies, over many mazes.

namespace conav::planner {
namespace {

struct Arguments {
  ExperimentOptions options;
  std::filesystem::path variants_file = ShippedVariants();
  std::vector<std::string> chosen;  // names of variants; none = all
};

void ChooseVariants(Arguments& arguments) {
  auto all = ReadSearchVariants(arguments.variants_file);
  if (arguments.chosen.empty()) {
    arguments.options.experiment.variants = std::move(all);
    return;
  }
  for (const std::string& name : arguments.chosen) {
    arguments.options.experiment.variants.push_back(
        FindVariant(all, name, arguments.variants_file));
  }
}

int Run(Arguments& arguments) {
  const ExperimentOptions& options = arguments.options;
  const int code = CheckFiles(
      kProgram, {{"--variants-file", arguments.variants_file}, {"--weights", options.weights}},
      {{"--json", options.json}, {"--csv", options.csv}});
  if (code != 0) return code;
  ChooseVariants(arguments);
  const auto episodes = PlayExperiment(options.experiment, options);
  if (!episodes) return Failed(kProgram, episodes.error());
  const auto summaries = Summarize(*episodes);
  auto done = WriteStandardOutput(ExperimentTable(options.experiment, summaries));
  if (done) done = WriteOutput(options.csv, ExperimentCsv(options.experiment, *episodes));
  if (done && !options.json.empty()) {
    done = WriteJsonOutput(options.json, ExperimentJson(options.experiment, summaries));
  }
  return ExitCode(kProgram, done);
}

void AddOptions(CLI::App& app, Arguments& arguments) {
  app.add_option("--variants-file", arguments.variants_file,
                 "YAML: search_variants: {NAME: {keys of planner.search, communication: {keys of "
                 "planner.communication}, method: ig-mcts or greedy}} (the variants that come with "
                 "conav)");
  app.add_option("--variants", arguments.chosen, "Only these, by name (all of the file)")
      ->delimiter(',');
  AddExperimentOptions(app, operators::OperatorKinds(), arguments.options);
}

}  // namespace
}  // namespace conav::planner

int main(int argc, char** argv) {
  using namespace conav::planner;
  CLI::App app("Experiments with the planner, with SIMULATED operators.", "conav experiment");
  app.require_subcommand(1);
  CLI::App* search = app.add_subcommand(
      "search",
      "Plays every variant of the search with every kind of simulated operator in the same mazes, "
      "in one process without bus and physics, and prints goals reached, moves, pictures and times "
      "with bootstrap intervals.");
  Arguments arguments;
  AddOptions(*search, arguments);
  TradeoffArguments tradeoff_arguments;
  const CLI::App* tradeoff = AddTradeoffCommand(app, tradeoff_arguments);
  if (conav::NamesUnknownCommand(app, argc, argv)) {
    return conav::Refused(
        kProgram,
        fmt::format("there is no experiment '{}'; there are search and tradeoff", argv[1]));
  }
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  try {
    return tradeoff->parsed() ? RunTradeoff(tradeoff_arguments) : Run(arguments);
  } catch (const conav::StartupError& error) {
    return conav::Refused(kProgram, error.what());
  }
}
