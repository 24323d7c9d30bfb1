#pragma once

#include <cstdint>
#include <string>

#include "common/runtime/result.h"
#include "common/segments/segment.h"
#include "nhpm/synthesis/annotator_population.h"
#include "sim/world/map_corruption.h"

namespace conav::nhpm {

/// What the person is shown.
struct MappingTaskOptions {
  std::string preset = "conav13";  // of the maze; see sim/world/maze_presets.h
  sim::MapCorruptionOptions corruption;
  int headings = 8;  // that a camera may look to, evenly spaced; 1 to 360
  /// After the goals a cell is drawn with a chance in proportion to `background` + how many cells
  /// of the map are wrong up to `attraction_cells` away (Euclidean, between cell centres); where
  /// that is 0 for all cells, one as likely as the other. Both are finite and not negative.
  double background = 0.5;
  double attraction_cells = 3.0;
};

/// The dataset collection task of paper Appendix A with a SYNTHETIC annotator: a maze of its own
/// and a map of it that is wrong. The robot, which knows both, drives the shortest way to one
/// target after the other: all goals, in random order, then `annotator.extra_pictures` random
/// cells, preferring areas where the map is wrong. At each target it takes a picture in a random
/// direction, with the lens of the simulated camera, and the annotator edits the map.
///
/// Gives one segment per picture; whether the trajectory is good enough to keep
/// (kAcceptedMappingAccuracy) is for the caller. Participant and session are left empty.
/// Seeded: equal arguments give equal trajectories.
/// Errors: kInvalidArgument for options out of range; those of MakeWorldSpec (kNotFound for an unknown preset) and CorruptMap.
[[nodiscard]] Result<Trajectory> RunMappingTask(const MappingTaskOptions& options,
                                                const Annotator& annotator, std::uint64_t seed);

/// The picture that a segment's query stands for, as a PictureReader looks at it.
Picture PictureOf(const PerceptionQuery& query);

}  // namespace conav::nhpm
