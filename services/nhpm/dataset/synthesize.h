#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "common/grid/mapping_tour.h"
#include "common/runtime/result.h"
#include "common/segments/segment.h"
#include "nhpm/dataset/annotators.h"
#include "sim/world/map_corruption.h"

namespace conav::nhpm {

/// The mapping task's maze, robot and pictures.
struct MappingTaskOptions {
  std::string preset = "conav13";  // of the maze; see sim/world/maze_presets.h
  sim::MapCorruptionOptions corruption;
  MappingTourOptions tour;
};

/// The dataset collection task of paper Appendix A with a SYNTHETIC annotator, in a maze of its own
/// with a corrupted map. The robot drives the shortest way from stop to stop of a MappingTour: all
/// goals, then `annotator.extra_pictures` more. At each it takes a picture with the lens of the
/// simulated camera, and the annotator edits the map.
///
/// Gives one segment per picture; the caller decides whether the trajectory is good enough to keep
/// (kAcceptedMappingAccuracy). Participant and session stay empty. Seeded: equal arguments give
/// equal trajectories.
/// Errors: kInvalidArgument for options out of range; those of MakeWorldSpec (kNotFound for an
///         unknown preset) and CorruptMap.
[[nodiscard]] Result<Trajectory> RunMappingTask(const MappingTaskOptions& options,
                                                const Annotator& annotator, std::uint64_t seed);

/// The picture of a segment's query, as a PictureReader looks at it.
Snapshot SnapshotOf(const PerceptionQuery& query);

struct SynthesisOptions {
  int trajectories = 400;  // accepted ones, at least 1
  std::uint64_t seed = 1;
  AnnotatorPopulation population;
  MappingTaskOptions task;
  /// Mazes that each person maps, one after the other, failed ones included. Paper Appendix A.
  int trajectories_per_person = 3;
  int threads = 1;
  /// Reports progress now and then: accepted and excluded trajectories so far.
  std::function<void(int accepted, int excluded)> progress;
};

struct Synthesis {
  SegmentSet set;    // exactly as many trajectories as requested
  int excluded = 0;  // failed the filter before the last accepted one
};

/// Trajectories of SYNTHETIC annotators, each in a maze of its own, until the requested number has
/// a final mapping accuracy above kAcceptedMappingAccuracy; leaves the others out (paper Appendix
/// A: 254 of 367).
///
/// Equal options give equal trajectories, whatever the number of threads; a larger number begins
/// with the same ones.
/// Errors: kInvalidArgument (fewer than one trajectory, per person, or thread), those of
///         RunMappingTask, kOutOfRange when the population is so careless that fewer than one in a
///         hundred trajectories is accepted.
[[nodiscard]] Result<Synthesis> SynthesizeSegments(const SynthesisOptions& options);

}  // namespace conav::nhpm
