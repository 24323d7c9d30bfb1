#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>
#include <sstream>
#include <vector>

#include "common/console/option_checks.h"
#include "common/segments/segment_file.h"
#include "common/segments/segment_json.h"
#include "common/segments/segment_labels.h"
#include "common/segments/segment_split.h"
#include "nhpm/commands/dataset_commands.h"
#include "nhpm/dataset/set_union.h"

// import, export, merge and split: from files to files.
namespace conav::nhpm {
namespace {

struct Arguments {
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

int Check(const Arguments& arguments, const std::vector<FileOption>& outputs) {
  std::vector<FileOption> inputs;
  for (const std::string& file : arguments.files) inputs.push_back({"file", file});
  return CheckFiles(kDatasetProgram, inputs, outputs);
}

int Import(const Arguments& arguments) {
  if (const int code = Check(arguments, {{"--out", arguments.out}}); code != 0) return code;
  const auto set = ReadAll(arguments.files, ImportSegmentsFile);
  return set ? WriteSet(arguments.out, *set) : Failed(set.error());
}

int Export(const Arguments& arguments) {
  if (const int code = Check(arguments, {{"--out", arguments.out}}); code != 0) return code;
  const auto set = ReadSegmentFile(arguments.files.front(),
                                   arguments.recover ? TornEnd::kDrop : TornEnd::kRefuse);
  if (!set) return Failed(set.error());
  if (arguments.out == "-") {
    std::ostringstream lines;
    ExportSegments(*set, lines);
    return ExitCode(WriteStandardOutput(lines.str()));
  }
  return ExitCode(ExportSegmentsFile(arguments.out, *set));
}

int Merge(const Arguments& arguments) {
  if (const int code = Check(arguments, {{"--out", arguments.out}}); code != 0) return code;
  auto set = ReadAll(arguments.files, [&](const std::string& file) {
    return ReadSegmentFile(file, arguments.recover ? TornEnd::kDrop : TornEnd::kRefuse);
  });
  if (!set) return Failed(set.error());
  std::erase_if(set->trajectories, [&](const Trajectory& trajectory) {
    return trajectory.final_mapping_accuracy < arguments.min_mapping_accuracy;
  });
  return WriteSet(arguments.out, *set);
}

std::string PartFile(const Arguments& arguments, const char* part) {
  return fmt::format("{}-{}.pb.zst", arguments.out, part);
}

int Split(const Arguments& arguments) {
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
                     const std::shared_ptr<Arguments>& arguments, int& exit_code,
                     int (*run)(const Arguments&)) {
  CLI::App* command = app.add_subcommand(name, description);
  command->callback([arguments, &exit_code, run] { exit_code = run(*arguments); });
  return command;
}

void AddFiles(CLI::App* command, Arguments& arguments, const std::string& what, int most) {
  command->add_option("file", arguments.files, what)->required()->expected(1, most);
}

void AddRecover(CLI::App* command, Arguments& arguments) {
  command->add_flag("--recover", arguments.recover,
                    "of a recording that was cut off, take what is complete");
}

constexpr int kManyFiles = 10000;

}  // namespace

void AddImportCommand(CLI::App& app, int& exit_code) {
  auto arguments = std::make_shared<Arguments>();
  CLI::App* command = AddCommand(
      app, "import", "Makes a segment file of JSON lines; docs/nhpm.md says what a line holds.",
      arguments, exit_code, Import);
  AddFiles(command, *arguments, "JSON lines; several files become one set", kManyFiles);
  command->add_option("--out", arguments->out, "segment file to write (.pb.zst)")->required();
}

void AddExportCommand(CLI::App& app, int& exit_code) {
  auto arguments = std::make_shared<Arguments>();
  CLI::App* command = AddCommand(
      app, "export", "Makes JSON lines of a segment file; importing them gives the same segments.",
      arguments, exit_code, Export);
  AddFiles(command, *arguments, "segment file (.pb.zst)", 1);
  command->add_option("--out", arguments->out, "file to write, - = standard output")
      ->default_str("-")
      ->default_val("-");
  AddRecover(command, *arguments);
}

void AddMergeCommand(CLI::App& app, int& exit_code) {
  auto arguments = std::make_shared<Arguments>();
  CLI::App* command = AddCommand(
      app, "merge",
      "Joins segment files, for example the recordings of many sessions, runs/*/segments.pb.zst.\n"
      "A trajectory that comes twice is refused, as it could be trained on and tested with.",
      arguments, exit_code, Merge);
  AddFiles(command, *arguments, "segment files (.pb.zst)", kManyFiles);
  command->add_option("--out", arguments->out, "segment file to write (.pb.zst)")->required();
  command
      ->add_option("--min-mapping-accuracy", arguments->min_mapping_accuracy,
                   "leave out trajectories that end below; the paper keeps those above 0.5. "
                   "Where nobody knew the true map the accuracy is 0")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  AddRecover(command, *arguments);
}

void AddSplitCommand(CLI::App& app, int& exit_code) {
  auto arguments = std::make_shared<Arguments>();
  CLI::App* command = AddCommand(
      app, "split",
      "Writes PREFIX-train.pb.zst, PREFIX-validation.pb.zst and PREFIX-test.pb.zst, split by\n"
      "trajectory as `conav train` and `conav evaluate` split the whole file with the same seed.",
      arguments, exit_code, Split);
  AddFiles(command, *arguments, "segment file (.pb.zst)", 1);
  command->add_option("--out-prefix", arguments->out, "PREFIX, folder and begin of the names")
      ->required();
  command
      ->add_option("--seed", arguments->seed,
                   "equal seeds split equally: --split-seed of conav train and conav evaluate")
      ->check(WholeNumber())
      ->capture_default_str();
  command->add_option("--test-share", arguments->shares.test, "of all trajectories")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  command->add_option("--validation-share", arguments->shares.validation, "of those left")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
}

}  // namespace conav::nhpm
