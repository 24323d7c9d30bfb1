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

/// What both studies tell their user while they run and when they cannot.
namespace conav::study {

/// "37 of 126 episodes, 1 failed, 2:10 left"; `pieces` is "episodes". `line` outlives it.
StudyListener ShowOn(ProgressLine& line, const std::string& pieces);

/// Prints `text` on standard output, or, where that holds the document of --json, on standard error.
/// Errors: kIo.
[[nodiscard]] Result<void> PrintTables(const std::string& text,
                                       const std::filesystem::path& json_file);

/// Prints why StudyFolder::Open did not give --out, and gives the exit code: 2 for kRefused, else 1.
int RefusedFolder(std::string_view program, const Error& error);

/// Prints how much there is and how to go on, and gives exit code 1. "2 of 60 episodes".
int Interrupted(std::string_view program, std::size_t done, std::size_t of,
                const std::string& pieces, const StudyFolder& folder);

using EpisodeStore = RecordStore<EpisodeRecord>;

/// The episodes that are in `folder`. Errors: as RecordStore::Open.
Result<EpisodeStore> OpenEpisodes(const StudyFolder& folder);

/// Runs one episode once, as PiecePlayer.
using EpisodePlayer = std::function<EpisodeRecord(int job, const PlannedEpisode& episode)>;

/// RunPieces for episodes, each record with its episode's name.
[[nodiscard]] Result<void> RunEpisodes(const std::vector<PlannedEpisode>& episodes, int jobs,
                                       const EpisodePlayer& play, EpisodeStore& store,
                                       const StopToken& stop, const StudyListener& listener);

/// The episode as a demo: all services as processes of their own. `base` says what all episodes
/// have in common: robots, camera, vendors, limits.
launcher::DemoOptions DemoFor(const launcher::DemoOptions& base, const PlannedEpisode& episode,
                              const std::string& subject, const StudyFolder& folder);

/// Runs episodes one after the other in a DDS domain that it keeps.
class DemoPlayer {
 public:
  /// `clock` and `stop` outlive it.
  DemoPlayer(std::filesystem::path program_folder, const Clock& clock, const StopToken& stop);

  /// Blocks. Whatever goes wrong is in the record.
  EpisodeRecord Play(const launcher::DemoOptions& options);

 private:
  std::filesystem::path program_folder_;
  const Clock& clock_;
  const StopToken& stop_;
  std::optional<launcher::DomainLease> lease_;
};

}  // namespace conav::study
