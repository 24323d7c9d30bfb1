#pragma once

#include <functional>
#include <vector>

#include "study/design.h"
#include "study/episode_record.h"
#include "study/run_pieces.h"

namespace conav::study {

using EpisodeStore = RecordStore<EpisodeRecord>;

/// The episodes that are in `folder`. Errors: as RecordStore::Open.
Result<EpisodeStore> OpenEpisodes(const StudyFolder& folder);

/// Runs one episode once, as PiecePlayer.
using EpisodePlayer = std::function<EpisodeRecord(int job, const PlannedEpisode& episode)>;

/// RunPieces for episodes, each record with its episode's name.
[[nodiscard]] Result<void> RunEpisodes(const std::vector<PlannedEpisode>& episodes, int jobs,
                                       const EpisodePlayer& play, EpisodeStore& store,
                                       const StopToken& stop, const StudyListener& listener);

}  // namespace conav::study
