#include "planner/search/reward.h"

#include <cmath>

#include "common/runtime/config.h"

namespace conav::planner {

void RewardOptions::Visit(ConfigReader& reader) {
  reader.Field("goal", goal, 0.0, 1e6);
  reader.Field("step", step, -1e6, 0.0);
  reader.Field("communication_cost", communication_cost, 0.0, 1e6);
  reader.Field("communication_step", communication_step, -1e6, 0.0);
  reader.Field("progress", progress, 0.0, 1e6);
}

double EnvironmentReward(bool reaches_goal, const RewardOptions& options) {
  return reaches_goal ? options.goal : options.step;
}

double GuidanceReward(bool guided_before, bool on_guidance, int path_length) {
  if (!guided_before || on_guidance) return 0.0;
  return -std::log(static_cast<double>(path_length));
}

double SmoothnessReward(int earlier_visits) { return -static_cast<double>(earlier_visits); }

double ProgressReward(double steps_saved, const RewardOptions& options) {
  return options.progress * steps_saved;
}

double CommunicationCost(int unvisited_guidance, const RewardOptions& options) {
  return options.communication_cost + unvisited_guidance;
}

double MoveReward(const PathState& path, const RewardOptions& options) {
  return EnvironmentReward(path.at_goal(), options) +
         GuidanceReward(path.guided_before(), path.on_guidance(), path.length()) +
         SmoothnessReward(path.earlier_visits()) + ProgressReward(path.progress(), options);
}

double CommunicationReward(const PathState& path, double information,
                           const RewardOptions& options) {
  return information - CommunicationCost(path.unvisited_guidance(), options) +
         options.communication_step;
}

}  // namespace conav::planner
