#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/cli/progress_line.h"
#include "common/runtime/clock.h"
#include "common/runtime/result.h"
#include "common/runtime/threads.h"
#include "launcher/demo_options.h"
#include "launcher/domain_lease.h"
#include "study/design.h"
#include "study/episode_record.h"
#include "study/study_folder.h"

/// Runs the pieces of a study (episodes, trials) in parallel, with attempts, records and progress.
namespace conav::study {

struct StudyProgress {
  std::size_t ran = 0;     // since the start of this program
  std::size_t done = 0;    // of `of`, including those of earlier runs
  std::size_t failed = 0;  // of those that ran, after the second attempt
  std::size_t of = 0;
};
using StudyListener = std::function<void(const StudyProgress&)>;

/// Runs one piece of a study, an episode or a trial, once. `job` is in [0, jobs); each job runs one
/// piece at a time. The result of an interrupted piece is ignored. Must not throw.
template <class Record>
using PiecePlayer = std::function<Record(int job, std::size_t index)>;

/// Whether `jobs` concurrent pieces each find a DDS domain. Errors: kInvalidArgument when
/// CONAV_DOMAIN leaves one for all of them.
[[nodiscard]] Result<void> CheckDomains(int jobs);

/// Attempts at a piece before its incomplete record is final.
inline constexpr int kMostAttempts = 2;

/// Runs one piece with repeated attempts; empty if it was interrupted.
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

/// Runs the pending pieces in order, `jobs` at a time; each record is on disk before the next piece
/// of its job begins. `Record` has `attempts`, is_complete() and has_failed().
/// Ends early when `stop` is requested, or with the error when a record cannot be written.
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

// Messages of both studies to their user.

/// "37 of 126 episodes, 1 failed, 2:10 left"; `pieces` is "episodes". `line` outlives it.
StudyListener ShowOn(ProgressLine& line, const std::string& pieces);

/// Prints `text` on standard output, or on standard error if standard output holds the document of
/// --json. Errors: kIo.
[[nodiscard]] Result<void> PrintTables(const std::string& text,
                                       const std::filesystem::path& json_file);

/// Prints why StudyFolder::Open rejected --out; returns the exit code: 2 for kRefused, else 1.
int RefusedFolder(std::string_view program, const Error& error);

/// Prints how much is done ("2 of 60 episodes") and how to resume; returns exit code 1.
int Interrupted(std::string_view program, std::size_t done, std::size_t of,
                const std::string& pieces, const StudyFolder& folder);

using EpisodeStore = RecordStore<EpisodeRecord>;

/// The episodes in `folder`. Errors: as RecordStore::Open.
Result<EpisodeStore> OpenEpisodes(const StudyFolder& folder);

/// Runs one episode once, as PiecePlayer.
using EpisodePlayer = std::function<EpisodeRecord(int job, const PlannedEpisode& episode)>;

/// RunPieces for episodes, each record with its episode's name.
[[nodiscard]] Result<void> RunEpisodes(const std::vector<PlannedEpisode>& episodes, int jobs,
                                       const EpisodePlayer& play, EpisodeStore& store,
                                       const StopToken& stop, const StudyListener& listener);

/// The episode as a demo: all services as processes of their own. `base` has the options that all
/// episodes share: robots, camera, vendors, limits.
launcher::DemoOptions DemoFor(const launcher::DemoOptions& base, const PlannedEpisode& episode,
                              const std::string& subject, const StudyFolder& folder);

/// Runs episodes one after the other in a DDS domain that it keeps.
class DemoPlayer {
 public:
  /// `clock` and `stop` outlive it.
  DemoPlayer(std::filesystem::path program_folder, const Clock& clock, const StopToken& stop);

  /// Blocks. The record holds any error.
  EpisodeRecord Play(const launcher::DemoOptions& options);

 private:
  std::filesystem::path program_folder_;
  const Clock& clock_;
  const StopToken& stop_;
  std::optional<launcher::DomainLease> lease_;
};

}  // namespace conav::study
