#include "planner/decision/make_method.h"

#include "common/runtime/demand.h"
#include "common/runtime/random.h"
#include "planner/decision/greedy_method.h"
#include "planner/decision/ig_mcts_method.h"
#include "planner/decision/instruction_method.h"
#include "planner/decision/mapping_method.h"
#include "planner/decision/teleop_method.h"

namespace conav::planner {
namespace {

constexpr std::uint64_t kPolicySeed = 1;

}  // namespace

std::unique_ptr<Method> MakeMethod(const std::string& name, const std::string& robot,
                                   const MethodConfig& config, std::uint64_t seed,
                                   std::shared_ptr<PerceptionModel> perception,
                                   std::shared_ptr<BeliefEstimate> estimate, const Clock& clock) {
  if (name == "instruction") return std::make_unique<InstructionMethod>(seed, clock);
  if (name == "teleop") return std::make_unique<TeleopMethod>();
  if (name == "greedy") return std::make_unique<GreedyMethod>(seed, clock);
  if (name == kMappingMethod) return std::make_unique<MappingMethod>(seed, clock);
  DEMAND(name == "ig-mcts", name, robot);
  return std::make_unique<IgMctsMethod>(
      config.search, seed, std::move(perception), clock, std::move(estimate),
      MakeCommunicationPolicy(config.communication, DeriveSeed(seed, kPolicySeed)));
}

}  // namespace conav::planner
