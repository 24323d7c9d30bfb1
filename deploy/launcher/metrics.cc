#include "launcher/metrics.h"

#include <algorithm>
#include <cmath>

namespace conav::launcher {

double Percentile(std::span<const double> values, double share) {
  if (values.empty()) return 0.0;
  std::vector<double> sorted(values.begin(), values.end());
  std::sort(sorted.begin(), sorted.end());
  const auto rank = static_cast<std::size_t>(std::ceil(share * static_cast<double>(sorted.size())));
  return sorted[std::clamp<std::size_t>(rank, 1, sorted.size()) - 1];
}

RobotMetrics MeasureRobot(const RobotRecord& robot) {
  RobotMetrics metrics;
  metrics.name = robot.name;
  metrics.world = robot.world;
  metrics.guidance = robot.guidance_given;
  metrics.decisions = robot.decisions;
  metrics.perception_model = robot.perception_model;
  metrics.decision_ms_median = Percentile(robot.decision_ms, 0.5);
  metrics.decision_ms_p99 = Percentile(robot.decision_ms, 0.99);
  if (!robot.state) return metrics;
  metrics.goals_reached = robot.state->goals_reached.size();
  metrics.goals_total = robot.state->goals_total;
  metrics.cell_moves = robot.state->cell_moves;
  metrics.low_level_steps = robot.state->low_level_steps;
  metrics.pictures = robot.state->pictures;
  metrics.picture_bytes = robot.state->picture_bytes;
  metrics.time_s = robot.finished_at.value_or(robot.state->stamp).ToSeconds();
  return metrics;
}

EpisodeMetrics Measure(const Episode& episode) {
  EpisodeMetrics metrics;
  metrics.all_goals_reached = episode.all_goals_reached();
  for (const RobotRecord& robot : episode.robots) metrics.robots.push_back(MeasureRobot(robot));
  metrics.before = {.mapping = 0.0, .cell = 0.0};
  metrics.after = {.mapping = 0.0, .cell = 0.0};
  int known = 0;
  for (const WorldRecord& world : episode.worlds) {
    if (!world.truth || !world.initial_map) continue;
    const BeliefGrid initial = ToBelief(*world.initial_map);
    const BeliefGrid& now = world.belief ? world.belief->wall_probability : initial;
    const MapAccuracy before = CompareMaps(*world.truth, *world.initial_map, initial);
    const MapAccuracy after = CompareMaps(*world.truth, *world.initial_map, now);
    metrics.before.mapping += before.mapping;
    metrics.before.cell += before.cell;
    metrics.after.mapping += after.mapping;
    metrics.after.cell += after.cell;
    ++known;
  }
  if (known > 0) {
    for (MapAccuracy* accuracy : {&metrics.before, &metrics.after}) {
      accuracy->mapping /= known;
      accuracy->cell /= known;
    }
  }
  return metrics;
}

nlohmann::ordered_json ToJson(const EpisodeMetrics& metrics) {
  nlohmann::ordered_json robots = nlohmann::ordered_json::array();
  for (const RobotMetrics& robot : metrics.robots) {
    robots.push_back({{"name", robot.name},
                      {"world", robot.world},
                      {"goals_reached", robot.goals_reached},
                      {"goals_total", robot.goals_total},
                      {"cell_moves", robot.cell_moves},
                      {"low_level_steps", robot.low_level_steps},
                      {"pictures", robot.pictures},
                      {"picture_bytes", robot.picture_bytes},
                      {"guidance", robot.guidance},
                      {"decisions", robot.decisions},
                      {"time_s", robot.time_s},
                      {"decision_ms_median", robot.decision_ms_median},
                      {"decision_ms_p99", robot.decision_ms_p99},
                      {"perception_model", robot.perception_model}});
  }
  return {{"all_goals_reached", metrics.all_goals_reached},
          {"mapping_accuracy_before", metrics.before.mapping},
          {"mapping_accuracy_after", metrics.after.mapping},
          {"cell_accuracy_before", metrics.before.cell},
          {"cell_accuracy_after", metrics.after.cell},
          {"robots", std::move(robots)}};
}

}  // namespace conav::launcher
