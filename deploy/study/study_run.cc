#include "study/study_run.h"

#include <mutex>

#include "common/runtime/workers.h"

namespace conav::study {
namespace {

constexpr int kMostAttempts = 2;

/// Nothing when it was interrupted.
std::optional<EpisodeRecord> Play(const PlannedEpisode& episode, int job, const EpisodePlayer& play,
                                  const StopToken& stop) {
  for (int attempt = 1;; ++attempt) {
    EpisodeRecord record = play(job, episode);
    if (stop.stop_requested()) return std::nullopt;
    record.name = episode.name;
    record.attempts = attempt;
    if (record.status == EpisodeStatus::kComplete || attempt == kMostAttempts) return record;
  }
}

std::vector<const PlannedEpisode*> Pending(const std::vector<PlannedEpisode>& episodes,
                                           const StudyFolder& folder) {
  std::vector<const PlannedEpisode*> pending;
  for (const PlannedEpisode& episode : episodes) {
    const auto record = folder.records().find(episode.name);
    if (record == folder.records().end() || record->second.status == EpisodeStatus::kFailed) {
      pending.push_back(&episode);
    }
  }
  return pending;
}

}  // namespace

Result<void> RunEpisodes(const std::vector<PlannedEpisode>& episodes, int jobs,
                         const EpisodePlayer& play, StudyFolder& folder, const StopToken& stop,
                         const StudyListener& listener) {
  const auto pending = Pending(episodes, folder);
  StudyProgress progress{.done = episodes.size() - pending.size(),
                         .of = episodes.size(),
                         .jobs = static_cast<std::size_t>(jobs)};
  std::mutex mutex;  // guards progress, folder, failure and the listener
  Result<void> failure;
  const auto give_up = [&] {
    const std::lock_guard lock(mutex);
    return stop.stop_requested() || !failure;
  };
  RunOnWorkers(jobs, static_cast<int>(pending.size()), [&](int job, int index) {
    if (give_up()) return;
    const auto record = Play(*pending[static_cast<std::size_t>(index)], job, play, stop);
    if (!record) return;
    const std::lock_guard lock(mutex);
    if (!failure) return;
    failure = folder.Save(*record);
    if (!failure) return;
    ++progress.ran;
    ++progress.done;
    if (record->status == EpisodeStatus::kFailed) ++progress.failed;
    listener(progress);
  });
  return failure;
}

}  // namespace conav::study
