#pragma once

#include <map>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <utility>

#include "common/runtime/result.h"
#include "study/study_folder.h"

namespace conav::study {

/// What is known of the pieces of a study (episodes, trials), by name, and kept in its folder.
/// `Record` has ToJson(record) and FromJson(text, record&) beside it.
template <class Record>
class RecordStore {
 public:
  /// With the records that earlier runs left in `<folder>/<kind>/`. `folder` outlives it.
  /// Errors: kIo, kMalformed with the file that cannot be read back.
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

  /// On disk when it returns, in one piece. Errors: kIo. Threads: one at a time.
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
