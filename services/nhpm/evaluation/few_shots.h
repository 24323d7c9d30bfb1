#pragma once

#include <cstddef>
#include <map>
#include <string>

#include "common/runtime/result.h"
#include "common/runtime/threads.h"
#include "nhpm/evaluation/evaluation.h"
#include "nhpm/model/weights_file.h"
#include "nhpm/training/adapt.h"

// One user: the matrix; what few segments teach is looked for by name.

namespace conav::nhpm {

/// What other people's segments taught.
struct FewShotModels {
  const NetworkModel& network;
  GlpfStatistics glpf;
  std::size_t segments = 0;  // that `glpf` counts
};

/// MBCE on other mazes of a person, after 0, 5, 20 and 100 of their segments:
///
///   0, 5, 20, 100           the network, adapted (Adapt)
///   glpf                    the GLPF of the others
///   glpf_5, _20, _100       fitted further: to the others, as 20 segments, and the person's
///   auto_0, _5, _20, _100   the network, adapted, and the GLPF of the others, weighed by how well
///                           network and GLPF, neither adapted, predicted the same segments
///                           (WeighedPerceptionModel)
///   oracle                  for synthetic people
///
/// Empty for a person with fewer segments, or fewer than two trajectories more.
/// Errors: those of Adapt and of the evaluation.
[[nodiscard]] Result<std::map<std::string, double>> FewShotLosses(const Person& person,
                                                                  const FewShotModels& models,
                                                                  int threads,
                                                                  const StopToken& stop);

}  // namespace conav::nhpm
