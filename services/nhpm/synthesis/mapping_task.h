#pragma once

#include <cstdint>
#include <string>

#include "common/mapping/mapping_tour.h"
#include "common/runtime/result.h"
#include "common/segments/segment.h"
#include "nhpm/synthesis/annotator_population.h"
#include "sim/world/map_corruption.h"

namespace conav::nhpm {

/// What the person is shown.
struct MappingTaskOptions {
  std::string preset = "conav13";  // of the maze; see sim/world/maze_presets.h
  sim::MapCorruptionOptions corruption;
  MappingTourOptions tour;
};

/// The dataset collection task of paper Appendix A with a SYNTHETIC annotator: a maze of its own
/// and a map of it that is wrong. The robot drives the shortest way from stop to stop of a
/// MappingTour: all goals, then `annotator.extra_pictures` more. At each it takes a picture with
/// the lens of the simulated camera, and the annotator edits the map.
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
