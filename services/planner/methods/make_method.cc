#include "planner/methods/make_method.h"

#include "common/runtime/random.h"
#include "common/runtime/result.h"
#include "planner/methods/baseline_methods.h"
#include "planner/methods/ig_mcts_method.h"

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
