// conav-dataset: makes, converts and shows segments, the training data of perception models.
#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <sstream>
#include <thread>
#include <vector>

#include "common/cli/batch.h"
#include "common/cli/cli.h"
#include "common/cli/progress_line.h"
#include "common/runtime/file.h"
#include "common/segments/segment.h"
#include "common/segments/segment_file.h"
#include "common/segments/segment_split.h"
#include "nhpm/dataset/set_summary.h"
#include "nhpm/dataset/synthesize.h"

// The subcommands of conav dataset: import, export, merge, split, describe, synthesize. Each Add...
// adds itself to `app`; if selected, it runs from CLI11's callback and leaves the program's exit code:
// 0 good, 1 failed, 2 wrong usage.
namespace conav::nhpm {
namespace {

constexpr const char* kDatasetProgram = "conav dataset";  // in messages

/// Prints `error` as every subcommand does and gives exit code 1.
int Failed(const Error& error) { return conav::Failed(kDatasetProgram, error); }

/// 0, or the exit code of Failed.
int ExitCode(const Result<void>& done) { return conav::ExitCode(kDatasetProgram, done); }

/// `recover`: the complete part of a truncated recording.
Result<SegmentSet> Read(const std::string& file, bool recover) {
  return ReadSegmentFile(file, recover ? TornEnd::kDrop : TornEnd::kRefuse);
}

struct ConvertArguments {
  std::vector<std::string> files;
  std::string out;
  bool recover = false;
  double min_mapping_accuracy = 0.0;
  std::uint64_t seed = kDefaultSplitSeed;
  SplitShares shares;
};

int WriteSet(const std::string& file, const SegmentSet& set) {
  if (const auto written = WriteSegmentFile(file, set); !written) return Failed(written.error());
  const std::string text = fmt::format("{}: {} trajectories, {} segments, edits made by {}\n", file,
                                       set.trajectories.size(), SegmentCount(set), OriginText(set));
  std::fputs(text.c_str(), stderr);
  return 0;
}

/// Reads all files with `read` and joins them.
template <class Read>
Result<SegmentSet> ReadAll(const std::vector<std::string>& files, Read&& read) {
  SetUnion all;
  for (const std::string& file : files) {
    auto set = read(file);
    if (!set) return set;
    if (const auto added = all.Add(*std::move(set), file); !added) {
      return tl::unexpected(added.error());
    }
  }
  return all.Take();
}

int Check(const ConvertArguments& arguments, std::vector<FileOption> outputs = {}) {
  if (outputs.empty()) outputs = {{"--out", arguments.out}};
  std::vector<FileOption> inputs;
  for (const std::string& file : arguments.files) inputs.push_back({"file", file});
  return CheckFiles(kDatasetProgram, inputs, outputs);
}

int Import(const ConvertArguments& arguments) {
  if (const int code = Check(arguments); code != 0) return code;
  const auto set = ReadAll(arguments.files, [](const std::string& file) -> Result<SegmentSet> {
    auto one = ImportSegmentsFile(file);
    if (!one || !one->trajectories.empty()) return one;
    return Fail(ErrorCode::kMalformed, file + ": has no trajectories");
  });
  return set ? WriteSet(arguments.out, *set) : Failed(set.error());
}

int Export(const ConvertArguments& arguments) {
  if (const int code = Check(arguments); code != 0) return code;
  const auto set = Read(arguments.files.front(), arguments.recover);
  if (!set) return Failed(set.error());
  if (arguments.out == "-") {
    std::ostringstream lines;
    ExportSegments(*set, lines);
    return ExitCode(WriteStandardOutput(lines.str()));
  }
  return ExitCode(ExportSegmentsFile(arguments.out, *set));
}

int Merge(const ConvertArguments& arguments) {
  if (const int code = Check(arguments); code != 0) return code;
  auto set = ReadAll(arguments.files,
                     [&](const std::string& file) { return Read(file, arguments.recover); });
  if (!set) return Failed(set.error());
  std::erase_if(set->trajectories, [&](const Trajectory& trajectory) {
    return trajectory.final_mapping_accuracy < arguments.min_mapping_accuracy;
  });
  return WriteSet(arguments.out, *set);
}

std::string PartFile(const ConvertArguments& arguments, const char* part) {
  return fmt::format("{}-{}.pb.zst", arguments.out, part);
}

int Split(const ConvertArguments& arguments) {
  const int checked = Check(arguments, {{"--out-prefix", PartFile(arguments, "train")},
                                        {"--out-prefix", PartFile(arguments, "validation")},
                                        {"--out-prefix", PartFile(arguments, "test")}});
  if (checked != 0) return checked;
  const auto set = ReadSegmentFile(arguments.files.front());
  if (!set) return Failed(set.error());
  const SegmentSplit split = SplitSegments(*set, arguments.seed, arguments.shares);
  int code = 0;
  for (const auto& [name, part] :
       {std::pair("train", &split.train), std::pair("validation", &split.validation),
        std::pair("test", &split.test)}) {
    code = std::max(code, WriteSet(PartFile(arguments, name), *part));
  }
  return code;
}

CLI::App* AddCommand(CLI::App& app, const std::string& name, const std::string& description,
                     const std::shared_ptr<ConvertArguments>& arguments, int& exit_code,
                     int (*run)(const ConvertArguments&)) {
  CLI::App* command = app.add_subcommand(name, description);
  command->callback([arguments, &exit_code, run] { exit_code = run(*arguments); });
  return command;
}

void AddFiles(CLI::App* command, ConvertArguments& arguments, const std::string& what, int most) {
  command->add_option("file", arguments.files, what)->required()->expected(1, most);
}

void AddRecover(CLI::App* command, bool& recover) {
  command->add_flag("--recover", recover, "read the complete part of a truncated recording");
}

constexpr int kManyFiles = 10000;

constexpr std::size_t kShownInText = 2;
constexpr std::size_t kShownInSvg = 5;

struct DescribeArguments {
  std::string file;
  std::string json;
  std::string svg;
  std::vector<std::size_t> segments;
  bool recover = false;
};

Result<std::vector<ChosenSegment>> Choose(const DescribeArguments& arguments, const SegmentSet& set,
                                          std::size_t count) {
  if (arguments.segments.empty()) return ChooseSegments(set, count);
  return ChooseSegments(set, arguments.segments);
}

Result<void> WriteSvg(const DescribeArguments& arguments, const SegmentSet& set,
                      const std::string& origin) {
  if (arguments.svg.empty()) return {};
  return Choose(arguments, set, kShownInSvg).and_then([&](const auto& chosen) {
    const std::string name = std::filesystem::path(arguments.file).filename().string();
    return WriteFile(arguments.svg,
                     SegmentsSvg(chosen, fmt::format("{}: edits made by {}", name, origin)));
  });
}

int Describe(const DescribeArguments& arguments) {
  const int code = CheckFiles(kDatasetProgram, {{"file", arguments.file}},
                              {{"--json", arguments.json}, {"--svg", arguments.svg}});
  if (code != 0) return code;
  const auto set = Read(arguments.file, arguments.recover);
  if (!set) return Failed(set.error());
  const auto chosen = Choose(arguments, *set, kShownInText);
  if (!chosen) return Refused(kDatasetProgram, chosen.error().text);
  const SetSummary summary = Summarize(*set);
  const auto drawn = WriteSvg(arguments, *set, summary.origin);
  if (!drawn) return Failed(drawn.error());
  const auto written = WriteJsonOutput(arguments.json, ToJson(summary));
  if (!written || arguments.json == "-") return ExitCode(written);
  std::string text = ToText(summary);
  for (const ChosenSegment& one : *chosen) text += "\n" + SegmentText(one);
  return ExitCode(WriteStandardOutput(text));
}

struct SynthesizeArguments {
  SynthesisOptions options;
  std::string population;
  std::string out = "data/synthetic.pb.zst";
  std::string json;
  Batch batch;
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

nlohmann::ordered_json ToJson(const SetSummary& summary, int excluded,
                              const SynthesizeArguments& arguments) {
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

/// Creates missing output folders. Fails before the work, not after it. Returns an exit code.
int PrepareOutputs(const SynthesizeArguments& arguments) {
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

int Run(SynthesizeArguments arguments) {
  if (const int code = PrepareOutputs(arguments); code != 0) return code;
  try {
    if (!arguments.population.empty()) {
      arguments.options.population = ReadPopulation(arguments.population);
    }
    arguments.batch.Start(ExpectedWaves(arguments.options.trajectories));
  } catch (const StartupError& error) {
    return Failed({ErrorCode::kInvalidArgument, error.what()});
  }
  const Batch& batch = arguments.batch;
  if (batch.is_kept()) {
    arguments.options.wave_file = [&](std::size_t wave) { return batch.FileOf(wave, ".pb.zst"); };
  }
  if (batch.piece()) return ExitCode(KeepWave(arguments.options, *batch.piece()));
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

void AddOptions(CLI::App& command, SynthesizeArguments& arguments) {
  SynthesisOptions& options = arguments.options;
  AddNumber(command, "--trajectories", options.trajectories,
            "number of accepted trajectories; the paper has 113. Leaves out rejected ones", 1,
            1000000);
  AddSeed(command, "--seed", options.seed,
          "the same seed gives the same file; a larger number begins with the same trajectories");
  command.add_option("--population", arguments.population,
                     "YAML file of the people; deploy/config/annotators.yaml explains every key "
                     "and contains the defaults");
  AddNumber(command, "--per-person", options.trajectories_per_person,
            "mazes that each person maps, failed ones included", 1, 1000000);
  AddShown(command, "--preset", options.task.preset,
           "preset of the mazes; ./conav maze --help lists them");
  command
      .add_option("--threads", options.threads,
                  "threads [one per core]; the result is the same on any number")
      ->check(Between(1, 1024));
  AddShown(command, "--out", arguments.out, "segment file; creates missing folders");
  command.add_option("--json", arguments.json,
                     "write the summary as JSON to this file, - = standard output");
  arguments.batch.AddOptions(command, "waves of 64 mazes");
}

void AddImportCommand(CLI::App& app, int& exit_code) {
  auto arguments = std::make_shared<ConvertArguments>();
  CLI::App* command = AddCommand(
      app, "import", "Converts JSON lines to a segment file. docs/segments.md describes the lines.",
      arguments, exit_code, Import);
  AddFiles(command, *arguments, "JSON lines; several files become one set", kManyFiles);
  command->add_option("--out", arguments->out, "segment file to write (.pb.zst)")->required();
}

void AddExportCommand(CLI::App& app, int& exit_code) {
  auto arguments = std::make_shared<ConvertArguments>();
  CLI::App* command =
      AddCommand(app, "export",
                 "Converts a segment file to JSON lines. Importing them gives the same segments.",
                 arguments, exit_code, Export);
  AddFiles(command, *arguments, "segment file (.pb.zst)", 1);
  command->add_option("--out", arguments->out, "file to write, - = standard output")
      ->default_str("-")
      ->default_val("-");
  AddRecover(command, arguments->recover);
}

void AddMergeCommand(CLI::App& app, int& exit_code) {
  auto arguments = std::make_shared<ConvertArguments>();
  CLI::App* command = AddCommand(app, "merge",
                                 "Joins segment files, for example the recordings of many "
                                 "sessions, runs/*/segments.pb.zst.\nRejects repeated "
                                 "trajectories, which could end up in both training and test.",
                                 arguments, exit_code, Merge);
  AddFiles(command, *arguments, "segment files (.pb.zst)", kManyFiles);
  command->add_option("--out", arguments->out, "segment file to write (.pb.zst)")->required();
  AddNumber(*command, "--min-mapping-accuracy", arguments->min_mapping_accuracy,
            "leave out trajectories with a lower final mapping accuracy; the paper keeps "
            "those above 0.5. Without a known true map the accuracy is 0",
            0.0, 1.0);
  AddRecover(command, arguments->recover);
}

void AddSplitCommand(CLI::App& app, int& exit_code) {
  auto arguments = std::make_shared<ConvertArguments>();
  CLI::App* command = AddCommand(
      app, "split",
      "Writes PREFIX-train.pb.zst, PREFIX-validation.pb.zst and PREFIX-test.pb.zst, split by\n"
      "trajectory as `conav train` and `conav evaluate` split the whole file with the same seed.",
      arguments, exit_code, Split);
  AddFiles(command, *arguments, "segment file (.pb.zst)", 1);
  command
      ->add_option("--out-prefix", arguments->out, "PREFIX: folder and beginning of the file names")
      ->required();
  AddSeed(*command, "--seed", arguments->seed,
          "the same seed gives the same split; see --split-seed of conav train and conav evaluate");
  AddNumber(*command, "--test-share", arguments->shares.test, "share of all trajectories", 0.0,
            1.0);
  AddNumber(*command, "--validation-share", arguments->shares.validation,
            "share of the remaining trajectories", 0.0, 1.0);
}

void AddDescribeCommand(CLI::App& app, int& exit_code) {
  auto arguments = std::make_shared<DescribeArguments>();
  CLI::App* command = app.add_subcommand(
      "describe",
      "Describes a segment file: origin of the edits, counts, edits per segment, accuracy of "
      "the\nmaps, and a few segments drawn with characters:\n  before: # wall, o path, > ^ < v "
      "camera; shown: . seen free, # seen wall;\n  after: + wall added, - wall removed");
  command->add_option("file", arguments->file, "one segment file (.pb.zst)")->required();
  command->add_option("--json", arguments->json,
                      "write the numbers to this file, - = standard output");
  command->add_option("--svg", arguments->svg, "draw a few segments to this file");
  command
      ->add_option("--segments", arguments->segments,
                   "numbers of the segments to draw, from 0 on: 3,14,15 (default: some with edits)")
      ->check(WholeNumber())
      ->delimiter(',');
  AddRecover(command, arguments->recover);
  command->callback([arguments, &exit_code] { exit_code = Describe(*arguments); });
}

void AddSynthesizeCommand(CLI::App& app, int& exit_code) {
  auto arguments = std::make_shared<SynthesizeArguments>();
  arguments->options.threads = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
  CLI::App* command = app.add_subcommand(
      "synthesize",
      "Generates segments of SYNTHETIC people in the mapping task of paper Appendix A. Each "
      "trajectory\nhas a random maze and a wrong map of it. The robot visits the goals, then "
      "places where the map\nis wrong, and sends a picture from each; the person edits the map. "
      "Leaves out trajectories with\na final mapping accuracy of 50 % or less.");
  AddOptions(*command, *arguments);
  command->callback([arguments, &exit_code] { exit_code = Run(*arguments); });
}

}  // namespace
}  // namespace conav::nhpm

int main(int argc, char** argv) {
  using namespace conav::nhpm;
  CLI::App app{
      "Segments: how a person edited the map after each picture (x, tau, o, x' of the "
      "paper's\nAppendix A). They come from synthetic annotators, from recorded sessions, or from "
      "an import.",
      "conav dataset"};
  app.require_subcommand(1);
  int exit_code = 0;
  AddSynthesizeCommand(app, exit_code);
  AddDescribeCommand(app, exit_code);
  AddImportCommand(app, exit_code);
  AddExportCommand(app, exit_code);
  AddMergeCommand(app, exit_code);
  AddSplitCommand(app, exit_code);
  if (conav::NamesUnknownCommand(app, argc, argv)) {
    return conav::Refused(
        kDatasetProgram,
        fmt::format("there is no command '{}'; conav dataset --help lists them", argv[1]));
  }
  if (const auto ended = conav::Parse(app, argc, argv)) return *ended;
  return exit_code;
}
