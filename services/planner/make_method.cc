#include "planner/make_method.h"

#include "common/runtime/demand.h"
#include "planner/ig_mcts_method.h"
#include "planner/instruction_method.h"
#include "planner/teleop_method.h"

namespace conav::planner {

std::unique_ptr<Method> MakeMethod(const std::string& name, const std::string& robot,
                                   const SearchConfig& search, std::uint64_t seed,
                                   std::shared_ptr<PerceptionModel> perception) {
  if (name == "instruction") return std::make_unique<InstructionMethod>(seed);
  if (name == "teleop") return std::make_unique<TeleopMethod>();
  DEMAND(name == "ig-mcts", name, robot);
  return std::make_unique<IgMctsMethod>(search, seed, std::move(perception));
}

}  // namespace conav::planner
