#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "common/msg/perception_model.h"
#include "planner/decision/method.h"
#include "planner/methods/method_config.h"
#include "planner/methods/operator_model.h"

namespace conav::planner {

/// The method called `name` ("ig-mcts", "instruction", "teleop", "greedy", kMappingMethod) for one robot. `config`,
/// `perception` and `estimate` (null = the published belief is believed) are used by ig-mcts only
/// and may be shared between the robots of a world. `clock` outlives the method.
std::unique_ptr<Method> MakeMethod(const std::string& name, const std::string& robot,
                                   const MethodConfig& config, std::uint64_t seed,
                                   std::shared_ptr<PerceptionModel> perception,
                                   std::shared_ptr<BeliefEstimate> estimate, const Clock& clock);

}  // namespace conav::planner
