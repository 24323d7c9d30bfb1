#include <algorithm>

#include "common/runtime/result.h"
#include "planner/decision/traffic.h"
#include "planner/methods/ig_mcts_method.h"

namespace conav::planner {
bool GuidanceFails(const Situation& situation) {
  if (situation.lacks_way) return true;
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
  return {.moves_since_snapshot = cells > 0 ? static_cast<int>(cells) - 1 : 0,
          .sent_before = situation.state.snapshots > 0,
          .guidance_fails = GuidanceFails(situation)};
}

CommunicationPolicy::CommunicationPolicy(const CommunicationConfig& config, std::uint64_t seed)
    : config_(config), random_(seed) {
  DEMAND(config.policy != "search");
}

bool CommunicationPolicy::IsDue(const CommunicationMoment& moment) {
  if (config_.policy == "random") return random_.Chance(config_.probability);
  if (config_.policy == "every") return moment.moves_since_snapshot >= config_.every_moves;
  if (config_.policy == "when_blocked") {  // once per place: the answer will not be a better one
    return moment.guidance_fails && (moment.moves_since_snapshot > 0 || !moment.sent_before);
  }
  return config_.policy == "threshold";  // whenever the best view is worth it; "never" is never
}

std::optional<CommunicationPolicy> MakeCommunicationPolicy(const CommunicationConfig& config,
                                                           std::uint64_t seed) {
  if (config.policy == "search") return std::nullopt;
  return CommunicationPolicy(config, seed);
}

Result<std::vector<PerceptionAnswer>> NoNewsModel::Predict(
    std::span<const PerceptionQuery> queries) {
  std::vector<PerceptionAnswer> answers;
  for (const PerceptionQuery& query : queries) {
    const Grid<float> nothing(query.belief.rows(), query.belief.columns(), 0.0F);
    answers.push_back({nothing, nothing});
  }
  return answers;
}

}  // namespace conav::planner
