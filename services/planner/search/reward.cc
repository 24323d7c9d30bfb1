#include "planner/search/reward.h"

#include "common/grid/geometry.h"
#include "common/runtime/config.h"

namespace conav::planner {

void RewardOptions::Visit(ConfigReader& reader) {
  reader.Field("goal", goal, 0.0, 1e6);
  reader.Field("step", step, -1e6, 0.0);
  reader.Field("communication_cost", communication_cost, 0.0, 1e6);
  reader.Field("communication_guidance", communication_guidance, 0.0, 1e6);
  reader.Field("communication_step", communication_step, -1e6, 0.0);
  reader.Field("view_turn", view_turn, 0.0, 1e6);
  reader.Field("answer", answer, 0.0, 1e6);
  reader.Field("progress", progress, 0.0, 1e6);
}

double TurnCost(const PathState& path, double heading_rad, const RewardOptions& options) {
  return options.view_turn * std::abs(WrapAngle(heading_rad - path.heading_rad()));
}

}  // namespace conav::planner
