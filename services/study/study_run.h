#pragma once

#include <fmt/core.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/cli/cli.h"
#include "common/runtime/file.h"
#include "study/record_store.h"

/// What the programs of all studies do with one: resume it, play it, report it.
namespace conav::study {

using Files = std::vector<std::pair<std::filesystem::path, std::string>>;

/// What a finished study writes and prints.
struct Results {
  std::string text;
  nlohmann::ordered_json json;
  Files files;  // besides results.json
  bool passed = true;
};

/// A study whose pieces are jobs of a Slurm array. Each plays one piece and stores its record, as a
/// local run does.
struct SlurmRun {
  bool submit = false;
  std::optional<std::size_t> piece;  // this process is the job of that piece
  std::vector<std::string> command;  // of this process
};
void AddSlurmOptions(CLI::App& app, SlurmRun& slurm, int argc, const char* const* argv);

/// Returns once the jobs of the `pending` ones of `of` pieces have ended, or been canceled by `stop`.
/// Counts the files in <folder>/<pieces>, and keeps scripts and outputs of jobs in <folder>/slurm.
/// Errors: kIo; kUnavailable with what sbatch says.
[[nodiscard]] Result<void> RunOnSlurm(const SlurmRun& slurm,
                                      const std::vector<std::size_t>& pending, std::size_t of,
                                      const std::filesystem::path& folder,
                                      const std::string& pieces, const StopToken& stop);

/// A study from its folder to its report. `Record` is that of its pieces.
template <class Record>
struct StudyRun {
  const char* program;
  std::string pieces;  // "episodes"; also the folder of the records
  std::filesystem::path out;
  std::filesystem::path json;  // a copy of results.json
  nlohmann::ordered_json design;
  std::vector<std::string> names;  // of the pieces
  Files files;                     // which the pieces read
  int jobs = 1;
  SlurmRun slurm;
  std::function<Record(int job, std::size_t index)> play;
  std::function<Results(const std::map<std::string, Record>&)> report;
};

inline Result<void> WriteFiles(const StudyFolder& folder, const Files& files) {
  for (const auto& [name, text] : files) {
    if (auto written = folder.Write(name, text); !written) return written;
  }
  return {};
}

/// Tables go to standard error if standard output holds the document of --json.
inline Result<void> Publish(const StudyFolder& folder, const Results& results,
                            const std::filesystem::path& json_file) {
  auto written = WriteFiles(folder, results.files)
                     .and_then([&] { return folder.Write("results.json", JsonText(results.json)); })
                     .and_then([&] { return WriteJsonOutput(json_file, results.json); });
  if (written && json_file != "-") return WriteStandardOutput(results.text);
  if (written) std::fputs(results.text.c_str(), stderr);
  return written;
}

/// Plays what is left, here or on Slurm.
template <class Record>
Result<void> Play(const StudyRun<Record>& run, const StudyFolder& folder,
                  RecordStore<Record>& store, const StopToken& stop) {
  if (run.slurm.piece) {
    const std::size_t index = *run.slurm.piece;
    const auto play = [&](int job, std::size_t) { return run.play(job, index); };
    return RunPieces<Record>({run.names.at(index)}, 1, play, store, stop, nullptr);
  }
  if (auto written = WriteFiles(folder, run.files); !written) return written;
  if (run.slurm.submit) {
    auto played = RunOnSlurm(run.slurm, store.Pending(run.names), run.names.size(), folder.path(),
                             run.pieces, stop);
    return played.and_then([&] { return store.ReadAgain(folder); });
  }
  ProgressLine line;
  return RunPieces(run.names, run.jobs, run.play, store, stop, ShowOn(line, run.pieces));
}

/// Resumes an earlier run of the same study, plays what is left, and reports. Returns the exit code.
template <class Record>
int Run(const StudyRun<Record>& run, const StopToken& stop) {
  const bool is_job = run.slurm.piece.has_value();
  const auto folder = StudyFolder::Open(std::filesystem::absolute(run.out), run.design, !is_job);
  if (!folder && folder.error().code == ErrorCode::kRefused) {
    return Refused(run.program, "--out " + folder.error().text);
  }
  if (!folder) return Failed(run.program, folder.error());
  auto store = RecordStore<Record>::Open(*folder, run.pieces);
  if (!store) return Failed(run.program, store.error());
  const auto played = Play(run, *folder, *store, stop);
  if (!played) return Failed(run.program, played.error());
  if (is_job && !stop.stop_requested()) return 0;
  if (stop.stop_requested() || !store->Has(run.names)) {
    const auto done = std::ranges::count_if(
        run.names, [&](const std::string& name) { return store->records().contains(name); });
    return Failed(run.program,
                  {ErrorCode::kUnavailable,
                   fmt::format("{}; {} of {} {} are in {}; the same command resumes",
                               stop.stop_requested() ? "interrupted" : "incomplete", done,
                               run.names.size(), run.pieces, folder->path().string())});
  }
  const Results results = run.report(store->records());
  const auto published = Publish(*folder, results, run.json);
  return published && !results.passed ? 1 : ExitCode(run.program, published);
}

}  // namespace conav::study
