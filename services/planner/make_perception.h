#pragma once

#include <memory>

#include "common/bus/participant.h"
#include "common/runtime/clock.h"
#include "planner/config.h"
#include "planner/search/perception_model.h"

namespace conav::planner {

/// The perception model that `config` asks for: the embedded GLPF, or the nhpm service with the
/// embedded GLPF to fall back on.
std::shared_ptr<PerceptionModel> MakePerception(bus::Participant& participant,
                                                const PlannerConfig& config, const Clock& clock);

}  // namespace conav::planner
