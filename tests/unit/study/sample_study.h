#pragma once

#include <string>

#include "study/design.h"
#include "study/report.h"

namespace conav::study {

/// Measures that a test can tell from their numbers.
inline EpisodeMeasures SampleMeasures(double snapshots, double steps) {
  return {.images = snapshots,
          .image_bytes = snapshots * 1024.0,
          .low_level_steps = steps,
          .cell_moves = steps / 10.0,
          .guidance = 3.0,
          .mapping_accuracy_after = 0.5,
          .goals_reached = 4.0,
          .goals_total = 4.0,
          .time_s = steps / 4.0,
          .all_goals_reached = true};
}

inline EpisodeRecord SampleRecord(const std::string& name, const EpisodeMeasures& measures) {
  return {.name = name,
          .status = EpisodeStatus::kComplete,
          .attempts = 1,
          .wall_s = 1.5,
          .run = "runs/x",
          .measures = measures};
}

/// Every episode of the design: ig-mcts sends 10 pictures, the others one per step; subject i takes
/// i steps more.
inline Records SampleRecords(const Design& design) {
  Records records;
  for (const PlannedEpisode& episode : design.episodes) {
    const double steps =
        400.0 + episode.subject + (episode.row.method == MethodKind::kTeleop ? 50.0 : 0.0);
    const double snapshots = episode.row.method == MethodKind::kIgMcts ? 10.0 : steps;
    records.emplace(episode.name, SampleRecord(episode.name, SampleMeasures(snapshots, steps)));
  }
  return records;
}

}  // namespace conav::study
