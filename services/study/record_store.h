#pragma once

#include <algorithm>
#include <filesystem>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "common/runtime/result.h"
#include "common/runtime/text.h"
#include "study/piece_runner.h"

namespace conav::study {

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
  /// A job of a study that runs on several hosts does not lock it: the program that gave it does.
  static Result<StudyFolder> Open(const std::filesystem::path& path,
                                  const nlohmann::ordered_json& design, bool lock = true);

  StudyFolder(StudyFolder&& other) noexcept;
  StudyFolder& operator=(StudyFolder&&) = delete;
  ~StudyFolder();

  const std::filesystem::path& path() const { return path_; }

  /// Takes a record; may throw nlohmann::json::exception.
  using RecordReader =
      std::function<Result<void>(const std::string& name, const nlohmann::json& record)>;
  /// Reads all records <kind>/<name>.json. Errors: kIo; kMalformed names the file, the reason and
  /// how to continue.
  [[nodiscard]] Result<void> ReadRecords(const std::string& kind, const RecordReader& read) const;
  /// Writes a file of this folder and creates its parent folders. Errors: kIo.
  [[nodiscard]] Result<void> Write(const std::filesystem::path& relative,
                                   std::string_view text) const;

 private:
  StudyFolder(std::filesystem::path path, int lock) : path_(std::move(path)), lock_(lock) {}

  std::filesystem::path path_;
  int lock_;
};

/// The first value in which two designs differ, by its path, with both values; empty = they are the
/// same.
std::string Difference(const nlohmann::ordered_json& there, const nlohmann::ordered_json& wanted);

/// SHA-256 of the design.
std::string Fingerprint(const nlohmann::ordered_json& design);

/// The records of a study's pieces (episodes, trials) by name, stored in its folder. `Record` needs
/// ToJson(record) and FromJson(json, record&) in its namespace.
template <class Record>
class RecordStore {
 public:
  /// Loads the records of earlier runs from `<folder>/<kind>/`. `folder` outlives it. Errors: as
  /// StudyFolder::ReadRecords.
  static Result<RecordStore> Open(const StudyFolder& folder, const std::string& kind) {
    RecordStore store(folder.path() / kind);
    if (auto read = store.ReadAgain(folder); !read) return tl::unexpected(read.error());
    return store;
  }
  /// What other processes have stored meanwhile, too. Errors: as Open.
  [[nodiscard]] Result<void> ReadAgain(const StudyFolder& folder) {
    return folder.ReadRecords(folder_.filename().string(),
                              [&](const std::string& name, const nlohmann::json& record) {
                                return FromJson(record, records_[name] = {});
                              });
  }

  /// The indices of those of `names` that have no record, or that of a failure.
  std::vector<std::size_t> Pending(const std::vector<std::string>& names) const {
    std::vector<std::size_t> pending;
    for (std::size_t index = 0; index < names.size(); ++index) {
      const auto known = records_.find(names[index]);
      if (known == records_.end() || known->second.has_failed()) pending.push_back(index);
    }
    return pending;
  }
  bool Has(const std::vector<std::string>& names) const {
    return std::ranges::all_of(names, [&](const auto& name) { return records_.contains(name); });
  }

  const std::map<std::string, Record>& records() const { return records_; }

  /// Returns once the record is on disk. Errors: kIo. Threads: one at a time.
  [[nodiscard]] Result<void> Save(const std::string& name, const Record& record) {
    auto written = WriteJsonFile(folder_ / (name + ".json"), ToJson(record));
    if (written) records_.insert_or_assign(name, record);
    return written;
  }

 private:
  explicit RecordStore(std::filesystem::path folder) : folder_(std::move(folder)) {}

  std::filesystem::path folder_;
  std::map<std::string, Record> records_;
};

/// Attempts at a piece before its incomplete record is final.
inline constexpr int kMostAttempts = 2;

/// RunPieces for the pieces called `names`: resumes where `store` ends, plays an incomplete piece
/// again, and stores each record. Pieces without a record are pending, and those that failed.
/// `Record` has `attempts`, is_complete() and has_failed(); the record of an interrupted piece is
/// ignored.
template <class Record>
[[nodiscard]] Result<void> RunPieces(const std::vector<std::string>& names, int jobs,
                                     const std::function<Record(int job, std::size_t index)>& play,
                                     RecordStore<Record>& store, const StopToken& stop,
                                     const PieceListener& listener) {
  const PlayPiece play_piece = [&](int job, std::size_t index) -> StorePiece {
    for (int attempt = 1;; ++attempt) {
      Record record = play(job, index);
      if (stop.stop_requested()) return nullptr;
      record.attempts = attempt;
      if (!record.is_complete() && attempt < kMostAttempts) continue;
      return [&store, &name = names[index], record = std::move(record)] {
        return store.Save(name, record).map([&record] { return record.has_failed(); });
      };
    }
  };
  return RunPieces(store.Pending(names), names.size(), jobs, play_piece, stop, listener);
}

}  // namespace conav::study
