#pragma once

#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>
#include <utility>

#include "common/runtime/result.h"
#include "study/statistics/report.h"

namespace conav::study {

/// How a report came about. Only the page has it: tables and JSON of equal studies are equal.
struct Provenance {
  std::string command;  // as typed, after ./conav
  std::string commit;   // of the build by ./conav; "unknown" for a program run by hand
  std::string date;     // of the report, UTC
  std::string machine;  // processor and number of cores
};

/// Describes this process. `argv` as in main().
Provenance DescribeRun(int argc, const char* const* argv);

/// The same, plus the entries of the study's design that fit on a line.
statistics::ReportSection ProvenanceSection(const Provenance& provenance,
                                            const nlohmann::ordered_json& design);

/// The folder of a study; an interrupted study resumes from it:
///
///   study.json             the design and its fingerprint
///   people/s01.yaml        each simulated operator, for `conav demo --operator`
///   episodes/<name>.json   a record as soon as the episode has ended; trials/ with --supervision
///   runs/<name>/           run folders of its attempts
///   episodes.csv, measures/<measure>.csv, report.html, results.json   at the end; with
///                          --supervision trials.csv, report.html, results.json, supervision.svg
///
/// One process at a time: while it lives, a second one gets an error.
class StudyFolder {
 public:
  /// Creates the folder, or opens the one of the same design. `design` is everything that the
  /// results depend on.
  /// Errors: kRefused (it belongs to another design, whose first difference is named; it holds
  ///         other files; another process uses it), kIo, kMalformed (study.json cannot be read
  ///         back).
  static Result<StudyFolder> Open(const std::filesystem::path& path,
                                  const nlohmann::ordered_json& design);

  StudyFolder(StudyFolder&& other) noexcept;
  StudyFolder& operator=(StudyFolder&&) = delete;
  ~StudyFolder();

  const std::filesystem::path& path() const { return path_; }
  std::filesystem::path person(const std::string& subject) const;
  std::filesystem::path runs(const std::string& episode) const;

  /// The contents of all records of this kind, by name. Errors: kIo.
  Result<std::map<std::string, std::string>> ReadRecords(const std::string& kind) const;
  /// Writes <kind>/<name>.json atomically. Errors: kIo.
  [[nodiscard]] Result<void> WriteRecord(const std::string& kind, const std::string& name,
                                         const nlohmann::ordered_json& record) const;
  /// kMalformed: the file, the reason, and how to continue.
  Error NotARecord(const std::string& kind, const std::string& name,
                   const std::string& reason) const;
  /// Writes a file of this folder and creates its parent folders. Errors: kIo.
  [[nodiscard]] Result<void> Write(const std::filesystem::path& relative,
                                   std::string_view text) const;

 private:
  StudyFolder(std::filesystem::path path, int lock) : path_(std::move(path)), lock_(lock) {}

  std::filesystem::path path_;
  int lock_;
};

/// SHA-256 of the design.
std::string Fingerprint(const nlohmann::ordered_json& design);

/// The records of a study's pieces (episodes, trials) by name, stored in its folder. `Record` needs
/// ToJson(record) and FromJson(text, record&) in its namespace.
template <class Record>
class RecordStore {
 public:
  /// Loads the records of earlier runs from `<folder>/<kind>/`. `folder` outlives it. Errors: kIo,
  /// kMalformed with the file that cannot be read back.
  static Result<RecordStore> Open(const StudyFolder& folder, const std::string& kind) {
    RecordStore store(folder, kind);
    auto texts = folder.ReadRecords(kind);
    if (!texts) return tl::unexpected(texts.error());
    for (const auto& [name, text] : *texts) {
      Record record;
      const Result<void> read = FromJson(text, record);
      if (!read) return tl::unexpected(folder.NotARecord(kind, name, read.error().text));
      store.records_.emplace(name, std::move(record));
    }
    return store;
  }

  const std::map<std::string, Record>& records() const { return records_; }

  /// Returns once the record is on disk. Errors: kIo. Threads: one at a time.
  [[nodiscard]] Result<void> Save(const std::string& name, const Record& record) {
    auto written = folder_->WriteRecord(kind_, name, ToJson(record));
    if (written) records_.insert_or_assign(name, record);
    return written;
  }

 private:
  RecordStore(const StudyFolder& folder, std::string kind)
      : folder_(&folder), kind_(std::move(kind)) {}

  const StudyFolder* folder_;
  std::string kind_;
  std::map<std::string, Record> records_;
};

}  // namespace conav::study
