// conav-experiment: compares variants of the search over many mazes.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <nlohmann/json.hpp>
#include <thread>

#include "common/console/console.h"
#include "common/console/progress_line.h"
#include "common/runtime/result.h"
#include "nhpm/model/load_model.h"
#include "planner/experiment/experiment_report.h"
#include "planner/experiment/search_experiment.h"

namespace conav::planner {
namespace {

constexpr const char* kProgram = "conav experiment";

struct Arguments {
  SearchExperiment experiment;
  std::filesystem::path variants_file;
  std::vector<std::string> chosen;  // names of variants; none = all
  std::string model = kDefaultPerceptionModel;
  std::filesystem::path weights;
  std::filesystem::path json;
  std::filesystem::path csv;
};

void ChooseVariants(Arguments& arguments) {
  auto all = ReadSearchVariants(arguments.variants_file);
  if (arguments.chosen.empty()) {
    arguments.experiment.variants = std::move(all);
    return;
  }
  for (const std::string& name : arguments.chosen) {
    const auto found = std::find_if(all.begin(), all.end(),
                                    [&](const SearchVariant& v) { return v.name == name; });
    if (found == all.end()) {
      std::string names;
      for (const SearchVariant& variant : all) names += " " + variant.name;
      throw StartupError(fmt::format("no variant {} in {}; there are{}", name,
                                     arguments.variants_file.string(), names));
    }
    arguments.experiment.variants.push_back(*found);
  }
}

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

int Run(Arguments& arguments) {
  const int code = CheckFiles(
      kProgram, {{"--variants-file", arguments.variants_file}, {"--weights", arguments.weights}},
      {{"--json", arguments.json}, {"--csv", arguments.csv}});
  if (code != 0) return code;
  ChooseVariants(arguments);
  const auto model = nhpm::LoadEditModel(arguments.model, arguments.weights, {});
  if (!model) return Failed(kProgram, model.error());
  Result<std::vector<ExperimentEpisode>> episodes;
  {
    ProgressLine line;
    episodes = RunSearchExperiment(arguments.experiment, *model, Progress(line));
  }
  if (!episodes) return Failed(kProgram, episodes.error());
  const auto summaries = Summarize(*episodes);
  auto done = WriteStandardOutput(ExperimentTable(arguments.experiment, summaries));
  if (done) done = WriteOutput(arguments.csv, ExperimentCsv(arguments.experiment, *episodes));
  if (done && !arguments.json.empty()) {
    done = WriteJsonOutput(arguments.json, ExperimentJson(arguments.experiment, summaries));
  }
  return ExitCode(kProgram, done);
}

void AddOptions(CLI::App& app, Arguments& arguments) {
  SearchExperiment& experiment = arguments.experiment;
  app.add_option(
      "--variants-file", arguments.variants_file,
      "YAML: search_variants: {NAME: {keys of planner.search}} (the variants that come with "
      "conav)");
  app.add_option("--variants", arguments.chosen, "Only these, by name (all of the file)")
      ->delimiter(',');
  experiment.operators = operators::OperatorKinds();
  app.add_option("--operators", experiment.operators, "Kinds of simulated operators")
      ->delimiter(',')
      ->check(CLI::IsMember(operators::OperatorKinds()))
      ->capture_default_str();
  app.add_option("--seeds", experiment.seeds, "How many mazes")
      ->check(CLI::Range(1, 100000))
      ->capture_default_str();
  app.add_option("--first-seed", experiment.first_seed, "Seed of the first maze")
      ->capture_default_str();
  app.add_option("--preset", experiment.preset, "Of the mazes; ./conav maze --help lists them")
      ->capture_default_str();
  app.add_option("--model", arguments.model, "Who predicts the operator's edits")
      ->check(CLI::IsMember({"nhpm", "glpf"}))
      ->capture_default_str();
  app.add_option("--weights", arguments.weights, "Of nhpm (the ones that come with conav)");
  experiment.threads = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  app.add_option(
         "--jobs", experiment.threads,
         "Episodes at once; changes no result but the times, and what a variant with a time "
         "budget gets done in it")
      ->check(CLI::Range(1, 256))
      ->capture_default_str();
  app.add_option("--json", arguments.json, "Write the summary to this file");
  app.add_option("--csv", arguments.csv, "Write a line per episode to this file");
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
  arguments.variants_file =
      conav::nhpm::ShippedWeights().parent_path().parent_path() / "config" / "search_variants.yaml";
  AddOptions(*search, arguments);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  try {
    return Run(arguments);
  } catch (const conav::StartupError& error) {
    return conav::Failed(kProgram, {conav::ErrorCode::kInvalidArgument, error.what()});
  }
}
