#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "operator/simulated/config.h"
#include "planner/config.h"
#include "sim/config.h"
#include "sim/world/world_spec.h"

namespace conav::launcher {

/// A named task: what the world, the planner and the person of a run are like. Others of their options
/// stay free.
struct Scenario {
  std::string name;
  std::string about;               // one sentence
  std::string preset = "conav13";  // of the maze
  int robots = 1;
  sim::CorruptionConfig corruption;
  double observation_distance_cells = 2.0;
  planner::GoalKnowledge goal_knowledge = planner::GoalKnowledge::kAll;
  std::string x_source = "observed";
  /// Of the person's paths: PathPlannerParameters::horizon.
  std::string horizon = "tour";
  bool infers_wings = false;
  int closing_doors = 0;  // of WorldOptions
  /// Goals are objects that a person has to recognise and give to the robot.
  bool marked_goals = false;

  void Visit(ConfigReader& reader);
  void ApplyTo(sim::SimConfig& config) const;
  void ApplyTo(sim::WorldOptions& world) const;
  void ApplyTo(planner::PlannerConfig& config) const;
  void ApplyTo(operators::SyntheticOperatorParameters& person) const;
};

/// deploy/config/scenarios.yaml, in the order of the file. Throws StartupError with the file, the
/// scenario, the key and the limit.
std::vector<Scenario> ReadScenarios(const std::filesystem::path& file);
std::filesystem::path ShippedScenarios();

/// Throws StartupError that lists the names.
Scenario FindScenario(const std::string& name);

}  // namespace conav::launcher
