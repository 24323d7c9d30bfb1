#pragma once

#include "launcher/run_log.h"

namespace conav::launcher {

/// One robot in a 5 x 5 world with walls around: the operator's map has one wall too many, at
/// (2,2), and lacks one, at (1,3). The robot went one cell east, sent a picture and went one on.
inline Episode SampleEpisode() {
  Episode episode = MakeEpisode(1, 1);
  OccupancyGrid truth(5, 5, Occupancy::kFree);
  for (std::size_t i = 0; i < truth.size(); ++i) {
    if (truth.OnBorder(truth.CellAt(i))) truth.values()[i] = Occupancy::kOccupied;
  }
  truth[{1, 3}] = Occupancy::kOccupied;
  OccupancyGrid initial = truth;
  initial[{2, 2}] = Occupancy::kOccupied;
  initial[{1, 3}] = Occupancy::kFree;
  episode.worlds[0].truth = truth;
  episode.worlds[0].initial_map = initial;

  RobotState state{.world = episode.worlds[0].name,
                   .robot = episode.robots[0].name,
                   .cell = {3, 1},
                   .goals_left = {{3, 3}},
                   .goals_total = 1,
                   .path = {{3, 1}}};
  Record(episode.robots[0], state);
  Record(episode.robots[0],
         Snapshot{.sequence_number = 1, .cell = {3, 2}, .path = {{3, 1}, {3, 2}}});
  state.cell = {3, 3};
  state.path = {{3, 2}, {3, 3}};
  state.snapshots = 1;
  state.goals_reached = {{3, 3}};
  state.goals_left = {};
  state.cell_moves = 2;
  state.low_level_steps = 17;
  state.images = 1;
  state.image_bytes = 12345;
  Record(episode.robots[0], state);
  return episode;
}

}  // namespace conav::launcher
