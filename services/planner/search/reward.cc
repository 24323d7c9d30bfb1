#include "planner/search/reward.h"

#include "common/grid/geometry.h"
#include "common/runtime/config.h"

namespace conav::planner {

void RewardOptions::Visit(ConfigReader& reader) {
  reader.Field("goal", goal, 0.0, 1e6);
  reader.Field("step", step, -1e6, 0.0);
  reader.Field("communication_cost", communication_cost, 0.0, 1e6);
  reader.Field("communication_step", communication_step, -1e6, 0.0);
  reader.Field("view_turn", view_turn, 0.0, 1e6);
  reader.Field("progress", progress, 0.0, 1e6);
}

double GuidanceReward(bool guided_before, bool on_guidance, int path_length) {
  if (!guided_before || on_guidance) return 0.0;
  return -std::log(static_cast<double>(path_length));
}

double TurnCost(const PathState& path, double heading_rad, const RewardOptions& options) {
  return options.view_turn * std::abs(WrapAngle(heading_rad - path.heading_rad()));
}

double CommunicationReward(const PathState& path, double heading_rad, double information,
                           const RewardOptions& options) {
  return information - CommunicationCost(path.unvisited_guidance(), options) -
         TurnCost(path, heading_rad, options) + options.communication_step;
}

RewardTerms MoveTerms(const PathState& path, const RewardOptions& options) {
  RewardTerms terms;
  (path.at_goal() ? terms.goals : terms.steps) = EnvironmentReward(path.at_goal(), options);
  terms.progress = ProgressReward(path.progress(), options);
  terms.guidance = GuidanceReward(path.guided_before(), path.on_guidance(), path.length());
  terms.smoothness = SmoothnessReward(path.earlier_visits());
  return terms;
}

RewardTerms CommunicationTerms(const PathState& path, double heading_rad, double information,
                               const RewardOptions& options) {
  RewardTerms terms;
  terms.information = information;
  terms.communication =
      -CommunicationCost(path.unvisited_guidance(), options) - TurnCost(path, heading_rad, options);
  terms.steps = options.communication_step;
  return terms;
}

}  // namespace conav::planner
