#include <catch2/catch.hpp>
#include <map>

#include "operator/config.h"
#include "operator/recording/config.h"
#include "planner/config.h"
#include "sim/config.h"
#include "study/live/task_session.h"

namespace conav::mapping_task {
namespace {

template <class Config>
Config Read(const std::map<std::string, std::string>& plan, const std::string& service) {
  Config config;
  ReadConfig(YAML::Load(plan.at(service))[service]["ros__parameters"], service, config);
  return config;
}

std::map<std::string, std::string> Plan(std::vector<std::string> methods = {}) {
  TaskOptions options;
  options.participant = "P07";
  options.methods = std::move(methods);
  const Maze maze{2, 4, 99, "/data/P07/maze-2-4"};
  const MazeSetting setting{43, 8123, {0.25}, "/data/P07"};
  std::map<std::string, std::string> plan;
  for (const PlannedService& service : PlanMaze(options, maze, setting)) {
    plan[service.name] = service.config;
  }
  return plan;
}

}  // namespace

TEST_CASE("the services of a maze get configurations that their own structs read back",
          "[mapping_task]") {
  const auto plan = Plan();
  CHECK(plan.size() == 4);
  const auto recorder = Read<recorder::RecorderConfig>(plan, "recorder");
  CHECK(recorder.file == "/data/P07/maze-2-4/recording.mcap");
  CHECK(recorder.facts.at("method") == "mapping");
  CHECK(Read<sim::SimConfig>(plan, "sim").seed == 99);
  CHECK(Read<sim::SimConfig>(plan, "sim").bus.domain_id == 43);
  const auto planner = Read<planner::PlannerConfig>(plan, "planner");
  CHECK(planner.method == "mapping");
  CHECK(planner.decision_file.empty());
}

TEST_CASE("the services of a study's part have its method, and stream where that needs it",
          "[mapping_task]") {
  const auto teleop = Plan({"ig-mcts", "teleop", "instruction"});
  CHECK(Read<sim::SimConfig>(teleop, "sim").camera.stream);
  CHECK(Read<planner::PlannerConfig>(teleop, "planner").method == "teleop");
  CHECK(Read<operators::OperatorConfig>(teleop, "operator").method == "teleop");
  CHECK(Read<operators::OperatorConfig>(teleop, "operator").task.kind == "study");
  const auto ours = Plan({"teleop", "ig-mcts", "instruction"});
  CHECK_FALSE(Read<sim::SimConfig>(ours, "sim").camera.stream);
  CHECK(Read<planner::PlannerConfig>(ours, "planner").perception_model == "nhpm");
}

TEST_CASE("the operator service of a maze records a person, and waits until they begin",
          "[mapping_task]") {
  const auto config = Read<operators::OperatorConfig>(Plan(), "operator");
  CHECK(config.console.port == 8123);
  CHECK(config.control.start_stopped);
  CHECK(config.recording.origin == "person");
  CHECK(config.recording.participant == "P07");
  CHECK(config.recording.session == "P07-maze2-4");
  CHECK(config.recording.file == "/data/P07/segments.pb.zst");
  CHECK(config.recording.mazes == std::vector<std::string>{"w1=conav13@99"});
  CHECK(config.recording.pictures);
  CHECK(config.task.kind == "mapping");
  CHECK(config.task.number == 2);
  CHECK(config.task.count == 3);
  CHECK(config.task.earlier == std::vector<double>{0.25});
  CHECK(config.task.result == "/data/P07/maze-2-4/result.json");
}

}  // namespace conav::mapping_task
