#include "planner/experiment/tradeoff_command.h"

#include <map>
#include <nlohmann/json.hpp>
#include <string>

#include "common/console/console.h"
#include "planner/experiment/tradeoff_plot.h"
#include "planner/experiment/tradeoff_report.h"

namespace conav::planner {
namespace {

const std::map<std::string, Effort> efforts{{"steps", Effort::kSteps}, {"moves", Effort::kMoves}};

}  // namespace

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

}  // namespace conav::planner
