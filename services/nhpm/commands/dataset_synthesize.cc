#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <thread>

#include "common/console/option_checks.h"
#include "common/console/progress_line.h"
#include "common/segments/segment_file.h"
#include "nhpm/commands/dataset_commands.h"
#include "nhpm/dataset/set_summary.h"
#include "nhpm/synthesis/synthesize.h"

namespace conav::nhpm {
namespace {

struct Arguments {
  SynthesisOptions options;
  std::string population;
  std::string out = "data/synthetic.pb.zst";
  std::string json;
};

double ExcludedShare(const SetSummary& summary, int excluded) {
  return excluded / (static_cast<double>(summary.trajectories) + excluded);
}

std::string Text(const SetSummary& summary, int excluded, const std::string& out) {
  return fmt::format(
      "synthetic trajectories  {} accepted, {} excluded ({:.1f} %: mapping accuracy {:.0f} % or "
      "less)\n"
      "segments                {}, {:.1f} per trajectory, {:.2f} edits per segment\n"
      "map of the person       cells right {:.1f} % -> {:.1f} %, mapping accuracy {:.1f} %\n"
      "written to              {}\n",
      summary.trajectories, excluded, 100.0 * ExcludedShare(summary, excluded),
      100.0 * kAcceptedMappingAccuracy, summary.segments, summary.segments_per_trajectory.mean,
      summary.edits_per_segment.mean, 100.0 * summary.initial_cell_accuracy.mean,
      100.0 * summary.final_cell_accuracy.mean, 100.0 * summary.final_mapping_accuracy.mean, out);
}

nlohmann::ordered_json ToJson(const SetSummary& summary, int excluded, const Arguments& arguments) {
  return {{"origin", "synthetic"},
          {"file", arguments.out},
          {"seed", arguments.options.seed},
          {"preset", arguments.options.task.preset},
          {"population", arguments.population},
          {"trajectories_per_person", arguments.options.trajectories_per_person},
          {"accepted", summary.trajectories},
          {"excluded", excluded},
          {"excluded_share", ExcludedShare(summary, excluded)},
          {"segments", summary.segments},
          {"segments_per_trajectory", summary.segments_per_trajectory.mean},
          {"edits", summary.edits},
          {"edits_per_segment", summary.edits_per_segment.mean},
          {"initial_cell_accuracy", summary.initial_cell_accuracy.mean},
          {"final_cell_accuracy", summary.final_cell_accuracy.mean},
          {"final_mapping_accuracy", summary.final_mapping_accuracy.mean}};
}

/// The folders of the outputs may be new. Fails before the work, not after it. Exit code.
int PrepareOutputs(const Arguments& arguments) {
  const std::vector<FileOption> inputs{{"--population", arguments.population}};
  const std::vector<FileOption> outputs{{"--out", arguments.out}, {"--json", arguments.json}};
  const auto distinct = CheckDistinct(inputs, outputs);
  if (!distinct) return Refused(kDatasetProgram, distinct.error().text);
  for (const auto& [option, path] : outputs) {
    std::error_code ignored;  // CheckFiles says what is wrong
    if (path.has_parent_path()) std::filesystem::create_directories(path.parent_path(), ignored);
  }
  return CheckFiles(kDatasetProgram, inputs, outputs);
}

using Clock = std::chrono::steady_clock;

std::string TimeLeft(Clock::time_point start, int accepted, int wanted) {
  if (accepted == 0) return {};
  const double spent_s = std::chrono::duration<double>(Clock::now() - start).count();
  return fmt::format(", {} left", DurationText(spent_s * (wanted - accepted) / accepted));
}

Result<Synthesis> SynthesizeWithProgress(SynthesisOptions options) {
  ProgressLine line;
  const auto start = Clock::now();
  options.progress = [&](int accepted, int excluded) {
    line.ShowNowAndThen(fmt::format("synthesize: {} of {} trajectories accepted, {} excluded{}",
                                    accepted, options.trajectories, excluded,
                                    TimeLeft(start, accepted, options.trajectories)));
  };
  return SynthesizeSegments(options);
}

int Run(Arguments arguments) {
  try {
    if (!arguments.population.empty()) {
      arguments.options.population = ReadPopulation(arguments.population);
    }
  } catch (const StartupError& error) {
    return Failed({ErrorCode::kInvalidArgument, error.what()});
  }
  if (const int code = PrepareOutputs(arguments); code != 0) return code;
  const auto synthesis = SynthesizeWithProgress(arguments.options);
  if (!synthesis) {
    Failed(synthesis.error());
    return synthesis.error().code == ErrorCode::kNotFound ? 2 : 1;  // no such preset
  }
  if (const auto written = WriteSegmentFile(arguments.out, synthesis->set); !written) {
    return Failed(written.error());
  }
  const SetSummary summary = Summarize(synthesis->set);
  if (arguments.json != "-") {
    const auto printed = WriteStandardOutput(Text(summary, synthesis->excluded, arguments.out));
    if (!printed) return Failed(printed.error());
  }
  return ExitCode(WriteJsonOutput(arguments.json, ToJson(summary, synthesis->excluded, arguments)));
}

void AddOptions(CLI::App& command, Arguments& arguments) {
  SynthesisOptions& options = arguments.options;
  command
      .add_option("--trajectories", options.trajectories,
                  "accepted ones; the paper has 113. Others are made and left out until there are "
                  "so many")
      ->check(CLI::Range(1, 1000000))
      ->capture_default_str();
  command
      .add_option("--seed", options.seed,
                  "equal seeds give equal files; more trajectories begin with the same ones")
      ->check(WholeNumber())
      ->capture_default_str();
  command.add_option(
      "--population", arguments.population,
      "YAML file of the people; deploy/config/annotators.yaml explains every key and "
      "holds the defaults");
  command
      .add_option("--per-person", options.trajectories_per_person,
                  "mazes that each person maps, failed ones included")
      ->check(CLI::Range(1, 1000000))
      ->capture_default_str();
  command
      .add_option("--preset", options.task.preset, "of the mazes; ./conav maze --help lists them")
      ->capture_default_str();
  command.add_option("--threads", options.threads, "changes nothing but the time")
      ->check(CLI::Range(1, 1024))
      ->capture_default_str();
  command.add_option("--out", arguments.out, "segment file; folders that are missing are made")
      ->capture_default_str();
  command.add_option("--json", arguments.json,
                     "write the summary as JSON to this file, - = standard output");
}

}  // namespace

void AddSynthesizeCommand(CLI::App& app, int& exit_code) {
  auto arguments = std::make_shared<Arguments>();
  arguments->options.threads = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
  CLI::App* command = app.add_subcommand(
      "synthesize",
      "Makes segments of SYNTHETIC people in the mapping task of paper Appendix A: a random maze\n"
      "and a wrong map of it for each trajectory; the robot visits the goals, then places where "
      "the\n"
      "map is wrong, and sends a picture from each; the person edits the map. Trajectories with a\n"
      "final mapping accuracy of 50 % or less are excluded.");
  AddOptions(*command, *arguments);
  command->callback([arguments, &exit_code] { exit_code = Run(*arguments); });
}

}  // namespace conav::nhpm
