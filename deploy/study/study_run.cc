#include "study/study_run.h"

#include <string>

namespace conav::study {

Result<EpisodeStore> OpenEpisodes(const StudyFolder& folder) {
  return EpisodeStore::Open(folder, "episodes");
}

Result<void> RunEpisodes(const std::vector<PlannedEpisode>& episodes, int jobs,
                         const EpisodePlayer& play, EpisodeStore& store, const StopToken& stop,
                         const StudyListener& listener) {
  std::vector<std::string> names;
  for (const PlannedEpisode& episode : episodes) names.push_back(episode.name);
  const PiecePlayer<EpisodeRecord> play_named = [&](int job, std::size_t index) {
    EpisodeRecord record = play(job, episodes[index]);
    record.name = episodes[index].name;
    return record;
  };
  return RunPieces(names, jobs, play_named, store, stop, listener);
}

}  // namespace conav::study
