#include <algorithm>

#include "common/runtime/result.h"
#include "planner/decision/traffic.h"
#include "planner/methods/ig_mcts_method.h"

namespace conav::planner {
namespace {

std::unique_ptr<CommunicationPolicy> MakeRule(const CommunicationConfig& config,
                                              std::uint64_t seed) {
  if (config.policy == "never") return std::make_unique<NeverPolicy>();
  if (config.policy == "random") return std::make_unique<RandomPolicy>(config.probability, seed);
  if (config.policy == "every") return std::make_unique<EveryMovesPolicy>(config.every_moves);
  if (config.policy == "when_blocked") return std::make_unique<WhenBlockedPolicy>();
  DEMAND(config.policy == "threshold", config.policy);
  return std::make_unique<ThresholdPolicy>(config.threshold_cells);
}

}  // namespace

bool GuidanceFails(const Situation& situation) {
  if (!situation.guidance) return situation.guided_before;
  const std::vector<Cell>& path = situation.guidance->path;
  const OccupancyGrid& map = situation.map.cells;
  // Where a path comes through a cell twice: what the robot has gone of it is free anyway.
  const auto here = std::find(path.begin(), path.end(), situation.state.cell);
  if (here == path.end() || here + 1 == path.end()) return true;
  return IsKnownBlocked(map, {here, path.end()});
}

CommunicationMoment MomentOf(const Situation& situation) {
  const std::size_t cells = situation.state.path.size();  // that picture's included
  return {.moves_since_picture = cells > 0 ? static_cast<int>(cells) - 1 : 0,
          .sent_before = situation.state.snapshots > 0,
          .guidance_fails = GuidanceFails(situation)};
}

std::unique_ptr<CommunicationPolicy> MakeCommunicationPolicy(const CommunicationConfig& config,
                                                             std::uint64_t seed) {
  if (config.policy == "search") return nullptr;
  auto rule = MakeRule(config, seed);
  rule->set_turn_cost(config.turn_cost);
  return rule;
}

}  // namespace conav::planner
