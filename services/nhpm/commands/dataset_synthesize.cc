#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <thread>

#include "common/runtime/file.h"
#include "common/segments/segment_file.h"
#include "nhpm/commands/dataset_commands.h"
#include "nhpm/commands/progress_line.h"
#include "nhpm/synthesis/synthesize.h"

namespace conav::nhpm {
namespace {

struct Arguments {
  SynthesisOptions options;
  std::string population;
  std::string out = "data/synthetic.pb.zst";
  std::string json;
};

/// How far it is, on standard error, at most once a second.
class Progress {
 public:
  explicit Progress(int wanted) : wanted_(wanted) {}

  void Tell(int accepted, int excluded) {
    const auto now = std::chrono::steady_clock::now();
    if (now < next_) return;
    next_ = now + std::chrono::seconds(1);
    line_.Show(fmt::format("synthesize: {} of {} trajectories accepted, {} excluded{}", accepted,
                           wanted_, excluded, accepted > 0 ? TimeLeft(now, accepted) : ""));
  }

 private:
  using Time = std::chrono::steady_clock::time_point;

  std::string TimeLeft(Time now, int accepted) const {
    const double spent_s = std::chrono::duration<double>(now - start_).count();
    return fmt::format(", {} left", DurationText(spent_s * (wanted_ - accepted) / accepted));
  }

  ProgressLine line_;
  int wanted_;
  Time start_ = std::chrono::steady_clock::now();
  Time next_ = start_ + std::chrono::seconds(1);
};

struct Summary {
  std::size_t accepted = 0;
  int excluded = 0;
  std::size_t segments = 0;
  int edits = 0;
  double initial_cell_accuracy = 0.0;  // means
  double final_cell_accuracy = 0.0;
  double final_mapping_accuracy = 0.0;

  double ExcludedShare() const { return excluded / (static_cast<double>(accepted) + excluded); }
  double SegmentsPerTrajectory() const {
    return static_cast<double>(segments) / static_cast<double>(accepted);
  }
  double EditsPerSegment() const { return edits / static_cast<double>(segments); }
};

Summary Summarise(const Synthesis& synthesis) {
  Summary summary;
  summary.accepted = synthesis.set.trajectories.size();
  summary.excluded = synthesis.excluded;
  const auto share = 1.0 / static_cast<double>(summary.accepted);
  for (const Trajectory& trajectory : synthesis.set.trajectories) {
    summary.segments += trajectory.segments.size();
    summary.initial_cell_accuracy += share * trajectory.initial_cell_accuracy;
    summary.final_cell_accuracy += share * trajectory.final_cell_accuracy;
    summary.final_mapping_accuracy += share * trajectory.final_mapping_accuracy;
    for (const Segment& segment : trajectory.segments) summary.edits += EditCount(segment);
  }
  return summary;
}

std::string Text(const Summary& summary, const std::string& out) {
  return fmt::format(
      "synthetic trajectories  {} accepted, {} excluded ({:.1f} %: mapping accuracy {:.0f} % or "
      "less)\n"
      "segments                {}, {:.1f} per trajectory, {:.2f} edits per segment\n"
      "map of the person       cells right {:.1f} % -> {:.1f} %, mapping accuracy {:.1f} %\n"
      "written to              {}\n",
      summary.accepted, summary.excluded, 100.0 * summary.ExcludedShare(),
      100.0 * kAcceptedMappingAccuracy, summary.segments, summary.SegmentsPerTrajectory(),
      summary.EditsPerSegment(), 100.0 * summary.initial_cell_accuracy,
      100.0 * summary.final_cell_accuracy, 100.0 * summary.final_mapping_accuracy, out);
}

nlohmann::ordered_json ToJson(const Summary& summary, const Arguments& arguments) {
  return {{"origin", "synthetic"},
          {"file", arguments.out},
          {"seed", arguments.options.seed},
          {"preset", arguments.options.task.preset},
          {"population", arguments.population},
          {"trajectories_per_person", arguments.options.trajectories_per_person},
          {"accepted", summary.accepted},
          {"excluded", summary.excluded},
          {"excluded_share", summary.ExcludedShare()},
          {"segments", summary.segments},
          {"segments_per_trajectory", summary.SegmentsPerTrajectory()},
          {"edits", summary.edits},
          {"edits_per_segment", summary.EditsPerSegment()},
          {"initial_cell_accuracy", summary.initial_cell_accuracy},
          {"final_cell_accuracy", summary.final_cell_accuracy},
          {"final_mapping_accuracy", summary.final_mapping_accuracy}};
}

/// The folder of the output may be new, the one above it not. Fails before the work, not after it.
Result<void> PrepareOutput(const std::filesystem::path& out) {
  std::error_code ignored;  // CheckWritable says what is wrong
  if (out.has_parent_path()) std::filesystem::create_directory(out.parent_path(), ignored);
  return CheckWritable(out);
}

Result<Synthesis> SynthesizeWithProgress(SynthesisOptions options) {
  Progress progress(options.trajectories);
  options.progress = [&](int accepted, int excluded) { progress.Tell(accepted, excluded); };
  return SynthesizeSegments(options);
}

int Run(Arguments arguments) {
  try {
    if (!arguments.population.empty()) {
      arguments.options.population = ReadPopulation(arguments.population);
    }
  } catch (const StartupError& error) {
    fmt::print(stderr, "conav-dataset: {}\n", error.what());
    return 2;
  }
  if (const auto ready = PrepareOutput(arguments.out); !ready) return Failed(ready.error());
  const auto synthesis = SynthesizeWithProgress(arguments.options);
  if (!synthesis) {
    Failed(synthesis.error());
    return synthesis.error().code == ErrorCode::kNotFound ? 2 : 1;  // no such preset
  }
  if (const auto written = WriteSegmentFile(arguments.out, synthesis->set); !written) {
    return Failed(written.error());
  }
  const Summary summary = Summarise(*synthesis);
  if (arguments.json != "-") {
    const int printed = WriteTextOutput(Text(summary, arguments.out));
    if (printed != 0 || arguments.json.empty()) return printed;
  }
  return WriteJsonOutput(ToJson(summary, arguments), arguments.json);
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
      ->check(CLI::NonNegativeNumber)
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
  command
      .add_option("--out", arguments.out,
                  "segment file; its folder is made when only that one is missing")
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
