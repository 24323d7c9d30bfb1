#include "planner/experiment/tradeoff_command.h"

#include <nlohmann/json.hpp>

#include "common/console/console.h"
#include "planner/experiment/tradeoff_plot.h"
#include "planner/experiment/tradeoff_report.h"

namespace conav::planner {

CLI::App* AddTradeoffCommand(CLI::App& app, TradeoffArguments& arguments) {
  CLI::App* command = app.add_subcommand(
      "tradeoff",
      "Plays IG-MCTS over costs of a picture, and every other communication policy over its "
      "parameter, in the same mazes with simulated operators; prints pictures against moves and "
      "where IG-MCTS needs fewer moves at equal pictures or fewer pictures at equal moves.");
  AddExperimentOptions(*command, {"careful", "hasty"}, arguments.options);
  command->add_option("--variants-file", arguments.variants_file,
                      "Variants of the search, as of the subcommand search");
  command
      ->add_option("--variant", arguments.variant,
                   "The search in which all policies play, by its name in that file")
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
  const TradeoffSweep sweep = MakeTradeoffSweep(search.config, options.experiment);
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
