#pragma once

#include <functional>
#include <vector>

#include "common/runtime/result.h"
#include "common/runtime/stop_token.h"
#include "study/design.h"
#include "study/study_folder.h"

namespace conav::study {

/// Runs one episode once. `job` is in [0, jobs) and never at work twice at a time. An interrupted
/// one returns whatever it likes. Must not throw.
using EpisodePlayer = std::function<EpisodeRecord(int job, const PlannedEpisode& episode)>;

struct StudyProgress {
  std::size_t ran = 0;     // since the start of this program
  std::size_t done = 0;    // among `of`, those of earlier runs too
  std::size_t failed = 0;  // of those that ran, after the second attempt
  std::size_t of = 0;
  std::size_t jobs = 1;
};
using StudyListener = std::function<void(const StudyProgress&)>;

/// Runs what has no record yet, and what failed in an earlier run, `jobs` at a time, in order; each
/// record is on disk before the next episode of its job begins. An episode that is not complete is
/// run a second time, and then kept as it is.
/// Ends early when `stop` is asked for, or with the error when a record cannot be written.
[[nodiscard]] Result<void> RunEpisodes(const std::vector<PlannedEpisode>& episodes, int jobs,
                                       const EpisodePlayer& play, StudyFolder& folder,
                                       const StopToken& stop, const StudyListener& listener);

}  // namespace conav::study
