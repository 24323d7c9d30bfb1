#pragma once

#include <cstdint>
#include <memory>

#include "common/msg/method.h"
#include "common/msg/perception_model.h"
#include "planner/decision/method.h"
#include "planner/methods/method_config.h"
#include "planner/methods/operator_model.h"

namespace conav::planner {

/// The method of one robot. Only ig-mcts and greedy use `config`, only ig-mcts `perception` and
/// `estimate` (null = the published belief is believed); the robots of a world may share them. `clock` outlives the method.
std::unique_ptr<Method> MakeMethod(MethodKind kind, const MethodConfig& config, std::uint64_t seed,
                                   std::shared_ptr<PerceptionModel> perception,
                                   std::shared_ptr<BeliefEstimate> estimate, const Clock& clock);

}  // namespace conav::planner
