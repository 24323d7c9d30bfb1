#pragma once

#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

#include "common/runtime/result.h"

namespace conav::study {

/// Where a study leaves everything, so that it can go on after whatever stopped it:
///
///   study.json             the design and its fingerprint
///   people/s01.yaml        each simulated operator, for `conav demo --operator`
///   episodes/<name>.json   a record as soon as the episode has ended; trials/ with --supervision
///   runs/<name>/           run folders of its attempts
///   episodes.csv, measures/<measure>.csv, report.html, results.json   at the end; with
///                          --supervision trials.csv, report.html, results.json, supervision.svg
///
/// One process at a time: a second one is refused while the first lives.
class StudyFolder {
 public:
  /// Makes the folder, or goes on with the one of the same design. `design` is everything that the
  /// results depend on.
  /// Errors: kRefused (it belongs to another design, whose first difference is named; it holds
  /// other files; another process uses it), kIo, kMalformed (study.json cannot be read back).
  static Result<StudyFolder> Open(const std::filesystem::path& path,
                                  const nlohmann::ordered_json& design);

  StudyFolder(StudyFolder&& other) noexcept;
  StudyFolder& operator=(StudyFolder&&) = delete;
  ~StudyFolder();

  const std::filesystem::path& path() const { return path_; }
  std::filesystem::path person(const std::string& subject) const;
  std::filesystem::path runs(const std::string& episode) const;

  /// What WriteRecord() left of this kind, by name. Errors: kIo.
  Result<std::map<std::string, std::string>> ReadRecords(const std::string& kind) const;
  /// Writes <kind>/<name>.json, whole or not at all. Errors: kIo.
  [[nodiscard]] Result<void> WriteRecord(const std::string& kind, const std::string& name,
                                         const nlohmann::ordered_json& record) const;
  /// kMalformed: that file, what is wrong with it, what to do.
  Error NotARecord(const std::string& kind, const std::string& name,
                   const std::string& reason) const;
  /// A file of this folder, its folders made. Errors: kIo.
  [[nodiscard]] Result<void> Write(const std::filesystem::path& relative,
                                   std::string_view text) const;

 private:
  StudyFolder(std::filesystem::path path, int lock) : path_(std::move(path)), lock_(lock) {}

  std::filesystem::path path_;
  int lock_;
};

/// SHA-256 of the design.
std::string Fingerprint(const nlohmann::ordered_json& design);

}  // namespace conav::study
