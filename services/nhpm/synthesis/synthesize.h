#pragma once

#include <cstdint>
#include <functional>

#include "common/runtime/result.h"
#include "common/segments/segment.h"
#include "nhpm/synthesis/annotator_population.h"
#include "nhpm/synthesis/mapping_task.h"

namespace conav::nhpm {

struct SynthesisOptions {
  int trajectories = 400;  // accepted ones, at least 1
  std::uint64_t seed = 1;
  AnnotatorPopulation population;
  MappingTaskOptions task;
  /// Mazes that each person maps, one after the other, failed ones included. Paper Appendix A.
  int trajectories_per_person = 3;
  int threads = 1;
  /// Told now and then how many trajectories were accepted and excluded so far.
  std::function<void(int accepted, int excluded)> progress;
};

struct Synthesis {
  SegmentSet set;    // exactly as many trajectories as asked for
  int excluded = 0;  // that failed the filter before the last accepted one
};

/// Trajectories of SYNTHETIC annotators, each in a maze of its own, until as many as wanted have a
/// final mapping accuracy above kAcceptedMappingAccuracy; the others are left out (paper Appendix
/// A: 254 of 367).
///
/// Equal options give equal trajectories, whatever the number of threads; more trajectories begin
/// with the same ones.
/// Errors: kInvalidArgument (fewer than one trajectory, per person, or thread), those of
/// RunMappingTask, kOutOfRange when the population is so careless that fewer than one in a hundred
/// trajectories is accepted.
[[nodiscard]] Result<Synthesis> SynthesizeSegments(const SynthesisOptions& options);

}  // namespace conav::nhpm
