#include "planner/search/reward.h"

#include "common/runtime/config.h"

namespace conav::planner {

void RewardOptions::Visit(ConfigReader& reader) {
  reader.Field("goal", goal, 0.0, 1e6);
  reader.Field("step", step, -1e6, 0.0);
  reader.Field("communication_cost", communication_cost, 0.0, 1e6);
  reader.Field("communication_step", communication_step, -1e6, 0.0);
  reader.Field("progress", progress, 0.0, 1e6);
}

double GuidanceReward(bool guided_before, bool on_guidance, int path_length) {
  if (!guided_before || on_guidance) return 0.0;
  return -std::log(static_cast<double>(path_length));
}

double CommunicationReward(const PathState& path, double information,
                           const RewardOptions& options) {
  return information - CommunicationCost(path.unvisited_guidance(), options) +
         options.communication_step;
}

}  // namespace conav::planner
