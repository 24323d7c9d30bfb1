#pragma once

#include <cstddef>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "common/runtime/result.h"
#include "common/runtime/stop_token.h"
#include "common/runtime/workers.h"
#include "study/record_store.h"

namespace conav::study {

struct StudyProgress {
  std::size_t ran = 0;     // since the start of this program
  std::size_t done = 0;    // among `of`, those of earlier runs too
  std::size_t failed = 0;  // of those that ran, after the second attempt
  std::size_t of = 0;
};
using StudyListener = std::function<void(const StudyProgress&)>;

/// Runs one piece of a study, an episode or a trial, once. `job` is in [0, jobs) and never at work
/// twice at a time. An interrupted one returns whatever it likes. Must not throw.
template <class Record>
using PiecePlayer = std::function<Record(int job, std::size_t index)>;

/// Whether `jobs` pieces at a time find a DDS domain each. Errors: kInvalidArgument where
/// CONAV_DOMAIN leaves one for all of them.
[[nodiscard]] Result<void> CheckDomains(int jobs);

/// A piece that is not complete is run so often, and then kept as it is.
inline constexpr int kMostAttempts = 2;

/// Nothing when it was interrupted.
template <class Record>
std::optional<Record> PlayPiece(int job, std::size_t index, const PiecePlayer<Record>& play,
                                const StopToken& stop) {
  for (int attempt = 1;; ++attempt) {
    Record record = play(job, index);
    if (stop.stop_requested()) return std::nullopt;
    record.attempts = attempt;
    if (record.is_complete() || attempt == kMostAttempts) return record;
  }
}

/// Indices of the names without a record, and of those that failed in an earlier run.
template <class Record>
std::vector<std::size_t> PendingPieces(const std::vector<std::string>& names,
                                       const RecordStore<Record>& store) {
  std::vector<std::size_t> pending;
  for (std::size_t index = 0; index < names.size(); ++index) {
    const auto record = store.records().find(names[index]);
    if (record == store.records().end() || record->second.has_failed()) pending.push_back(index);
  }
  return pending;
}

/// Runs what is pending, `jobs` at a time, in order; each record is on disk before the next piece of
/// its job begins. `Record` has `attempts`, is_complete() and has_failed().
/// Ends early when `stop` is asked for, or with the error when a record cannot be written.
template <class Record>
[[nodiscard]] Result<void> RunPieces(const std::vector<std::string>& names, int jobs,
                                     const PiecePlayer<Record>& play, RecordStore<Record>& store,
                                     const StopToken& stop, const StudyListener& listener) {
  const std::vector<std::size_t> pending = PendingPieces(names, store);
  StudyProgress progress{.done = names.size() - pending.size(), .of = names.size()};
  std::mutex mutex;  // guards progress, store, failure and the listener
  Result<void> failure;
  const auto give_up = [&] {
    const std::lock_guard lock(mutex);
    return stop.stop_requested() || !failure;
  };
  RunOnWorkers(jobs, static_cast<int>(pending.size()), [&](int job, int number) {
    if (give_up()) return;
    const std::size_t index = pending[static_cast<std::size_t>(number)];
    const auto record = PlayPiece(job, index, play, stop);
    if (!record) return;
    const std::lock_guard lock(mutex);
    if (!failure) return;
    failure = store.Save(names[index], *record);
    if (!failure) return;
    ++progress.ran;
    ++progress.done;
    if (record->has_failed()) ++progress.failed;
    listener(progress);
  });
  return failure;
}

}  // namespace conav::study
