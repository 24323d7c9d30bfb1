#include "planner/methods/make_method.h"

#include <fmt/core.h>

#include <algorithm>

#include "common/runtime/random.h"
#include "common/runtime/text.h"
#include "planner/methods/baseline_methods.h"
#include "planner/methods/ig_mcts_method.h"

namespace conav::planner {
namespace {

constexpr std::uint64_t kPolicySeed = 1;

}  // namespace

SearchConfig SearchFrom(const std::string& name) {
  SearchConfig search;
  if (std::ranges::find(kSearchPresets, name) != kSearchPresets.end()) {
    search.StartFrom(name);
    return search;
  }
  const auto document = ReadYamlFile(name);
  if (!document) {
    throw StartupError(fmt::format("neither a search ({}) nor a readable file: {}",
                                   Join(kSearchPresets, ", "), document.error().text));
  }
  if (!document->IsMap() || !(*document)["search"]) {
    throw StartupError(name + ": no map search: {keys of planner.search}");
  }
  ReadConfig((*document)["search"], name + ": search", search);
  return search;
}

std::unique_ptr<Method> MakeMethod(MethodKind kind, const MethodConfig& config, std::uint64_t seed,
                                   std::shared_ptr<PerceptionModel> perception,
                                   std::shared_ptr<BeliefEstimate> estimate, const Clock& clock) {
  switch (kind) {
    case MethodKind::kIgMcts:
      break;
    case MethodKind::kInstruction:
      return std::make_unique<InstructionMethod>(seed, clock);
    case MethodKind::kTeleop:
      return std::make_unique<TeleopMethod>();
    case MethodKind::kGreedy:
      return std::make_unique<GreedyMethod>(seed, clock,
                                            config.search.graph == SearchGraph::kRegions
                                                ? std::optional(config.search.regions)
                                                : std::nullopt);
    case MethodKind::kMapping:
      return std::make_unique<MappingMethod>(seed, clock);
  }
  return std::make_unique<IgMctsMethod>(
      config.search, seed, std::move(perception), clock, std::move(estimate),
      MakeCommunicationPolicy(config.communication, DeriveSeed(seed, kPolicySeed)));
}

}  // namespace conav::planner
