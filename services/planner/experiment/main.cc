// conav-experiment: compares variants of the search, and communication policies, over many mazes.
#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "common/console/console.h"
#include "common/console/option_checks.h"
#include "common/runtime/result.h"
#include "planner/experiment/experiment_options.h"
#include "planner/experiment/experiment_report.h"
#include "planner/experiment/tradeoff_command.h"

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
