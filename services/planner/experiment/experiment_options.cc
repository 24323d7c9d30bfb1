#include "planner/experiment/experiment_options.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <thread>

#include "common/console/option_checks.h"
#include "common/console/progress_line.h"
#include "nhpm/model/load_model.h"
#include "sim/world/maze_presets.h"

namespace conav::planner {
namespace {

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

std::shared_ptr<const nhpm::EditModel> ModelOf(const ExperimentOptions& options) {
  if (options.model == kGlpfModel && !options.weights.empty()) {
    throw StartupError("--weights: --model glpf has none");
  }
  auto model = nhpm::LoadEditModel(options.model, options.weights, {});
  if (!model) throw StartupError("--weights " + model.error().text);
  return *std::move(model);
}

}  // namespace

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
  app.add_option(
         "--jobs", experiment.threads,
         "Episodes at once; changes no result but the times, and what a variant with a time "
         "budget gets done in it")
      ->check(CLI::Range(1, 256))
      ->capture_default_str();
  app.add_option("--json", options.json, "Write the summary to this file");
  app.add_option("--csv", options.csv, "Write a line per episode to this file");
}

Result<std::vector<ExperimentEpisode>> PlayExperiment(const SearchExperiment& experiment,
                                                      const ExperimentOptions& options) {
  const auto model = ModelOf(options);
  ProgressLine line;
  return RunSearchExperiment(experiment, model, Progress(line));
}

}  // namespace conav::planner
