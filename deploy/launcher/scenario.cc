#include "launcher/scenario.h"

#include <fmt/core.h>

#include <algorithm>

#include "common/runtime/file.h"

namespace conav::launcher {

void Scenario::Visit(ConfigReader& reader) {
  reader.Field("about", about);
  reader.Field("preset", preset);
  reader.Field("robots", robots, 1, 64);
  reader.Section("corruption", corruption);
  reader.Field("observation_distance_cells", observation_distance_cells, 0.5, 100.0);
  reader.Choice("goal_knowledge", goal_knowledge, planner::kGoalKnowledges);
  reader.Choice("x_source", x_source, {"observed", "estimated", "none"});
  reader.Choice("horizon", horizon, {"tour", "next_goal", "away"});
  reader.Field("infers_wings", infers_wings);
  reader.Field("marked_goals", marked_goals);
  reader.Field("closing_doors", closing_doors, 0, 100);
}

void Scenario::ApplyTo(sim::SimConfig& config) const {
  config.preset = preset;
  config.corruption = corruption;
  config.closing_doors = closing_doors;
  config.keeps_goals = !marked_goals;
  config.observation_distance_cells = observation_distance_cells;
}

void Scenario::ApplyTo(sim::WorldOptions& world) const {
  world.preset = preset;
  world.wrong_share = corruption.wrong_share;
  world.false_wall_share = corruption.false_wall_share;
  world.wing_error = corruption.wing_error;
  world.closing_doors = closing_doors;
}

void Scenario::ApplyTo(planner::PlannerConfig& config) const {
  config.goal_knowledge = goal_knowledge;
  config.x_source = x_source;
}

void Scenario::ApplyTo(operators::SyntheticOperatorParameters& person) const {
  // A person who misleads on purpose, or plans no further than the next goal, stays so.
  if (person.planner.horizon == "tour") person.planner.horizon = horizon;
  person.infers_wings = infers_wings;
  person.marks_goals = marked_goals;
}

std::vector<Scenario> ReadScenarios(const std::filesystem::path& file) {
  const auto document = ReadYamlFile(file);
  if (!document) throw StartupError(document.error().text);
  const YAML::Node section = document->IsMap() ? (*document)["scenarios"] : YAML::Node();
  if (!section || !section.IsMap() || section.size() == 0) {
    throw StartupError(file.string() + ": no map scenarios: {NAME: {...}}");
  }
  std::vector<Scenario> scenarios;
  for (const auto& entry : section) {
    Scenario& scenario = scenarios.emplace_back();
    ReadConfig(entry.second, file.string() + ": " + entry.first.Scalar(), scenario);
    scenario.name = entry.first.Scalar();
  }
  return scenarios;
}

std::filesystem::path ShippedScenarios() { return ShippedFile("config/scenarios.yaml"); }

Scenario FindScenario(const std::string& name) {
  std::string names;
  for (Scenario& scenario : ReadScenarios(ShippedScenarios())) {
    if (scenario.name == name) return scenario;
    names += " " + scenario.name;
  }
  throw StartupError(fmt::format("no scenario '{}'; there are{}", name, names));
}

}  // namespace conav::launcher
