#pragma once

#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

#include "common/grid/map_accuracy.h"
#include "launcher/episode.h"

namespace conav::launcher {

/// The value below which `share` of the values lie (nearest rank); 0 without values.
double Percentile(std::span<const double> values, double share);

struct RobotMetrics {
  std::string name;
  std::string world;
  std::uint64_t goals_reached = 0;
  std::uint64_t goals_total = 0;
  std::uint64_t cell_moves = 0;
  std::uint64_t low_level_steps = 0;  // of 0.25 s
  std::uint64_t pictures = 0;
  std::uint64_t picture_bytes = 0;
  std::uint64_t guidance = 0;
  std::uint64_t decisions = 0;
  double time_s = 0.0;  // simulation time until its goals were reached, or so far
  double decision_ms_median = 0.0;
  double decision_ms_p99 = 0.0;
  std::string perception_model;  // that answered the newest decision; "fallback: glpf" among them
};

struct EpisodeMetrics {
  bool all_goals_reached = false;
  MapAccuracy before;  // means over the worlds whose maps are known
  MapAccuracy after;
  std::vector<RobotMetrics> robots;
};

RobotMetrics MeasureRobot(const RobotRecord& robot);
EpisodeMetrics Measure(const Episode& episode);

/// The object of --json without the facts that only the launcher knows (seed, method, ...).
nlohmann::ordered_json ToJson(const EpisodeMetrics& metrics);

}  // namespace conav::launcher
