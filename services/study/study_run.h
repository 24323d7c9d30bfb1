#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
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

/// Resumes an earlier run of the same study, plays what is left, and reports. Returns the exit code.
template <class Record>
int Run(const StudyRun<Record>& run, const StopToken& stop) {
  const auto folder = StudyFolder::Open(std::filesystem::absolute(run.out), run.design);
  if (!folder && folder.error().code == ErrorCode::kRefused) {
    return Refused(run.program, "--out " + folder.error().text);
  }
  if (!folder) return Failed(run.program, folder.error());
  auto store = RecordStore<Record>::Open(*folder, run.pieces);
  if (!store) return Failed(run.program, store.error());
  const auto played = WriteFiles(*folder, run.files).and_then([&] {
    ProgressLine line;
    return RunPieces(run.names, run.jobs, run.play, *store, stop, ShowOn(line, run.pieces));
  });
  if (!played) return Failed(run.program, played.error());
  if (stop.stop_requested()) {
    const auto done = std::ranges::count_if(
        run.names, [&](const std::string& name) { return store->records().contains(name); });
    return Failed(run.program,
                  {ErrorCode::kUnavailable,
                   fmt::format("interrupted; {} of {} {} are in {}; the same command resumes", done,
                               run.names.size(), run.pieces, folder->path().string())});
  }
  const Results results = run.report(store->records());
  const auto published = Publish(*folder, results, run.json);
  return published && !results.passed ? 1 : ExitCode(run.program, published);
}

}  // namespace conav::study
