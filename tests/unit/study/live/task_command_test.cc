#include "study/live/task_command.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <map>
#include <set>

#include "common/runtime/file.h"
#include "operator/config.h"
#include "operator/recording/config.h"
#include "planner/config.h"
#include "sim/config.h"
#include "support/refusal.h"
#include "support/temporary_folder.h"

namespace conav::mapping_task {
namespace {

constexpr std::array kOrder{MethodKind::kIgMcts, MethodKind::kInstruction, MethodKind::kTeleop};

TaskOptions Good() {
  TaskOptions options;
  options.participant = "P07";
  options.camera = "none";
  return options;
}

TEST_CASE("each participant gets mazes of their own, the same ones again", "[mapping_task]") {
  TaskOptions options = Good();
  const auto seeds = SeedsOf(options);
  CHECK(std::set<std::uint64_t>(seeds.begin(), seeds.end()).size() == 3);
  CHECK(SeedsOf(options) == seeds);
  options.mazes = 2;
  CHECK(SeedsOf(options) == std::vector(seeds.begin(), seeds.begin() + 2));
  options.participant = "P08";
  CHECK(SeedsOf(options)[0] != seeds[0]);
  options.maze_seeds = {7, 9};
  CHECK(SeedsOf(options) == std::vector<std::uint64_t>{7, 9});
}

TEST_CASE("over all orders of a study each method is as often at each place", "[mapping_task]") {
  const std::vector<MethodKind> methods{kOrder.begin(), kOrder.end()};
  std::map<MethodKind, int> first;
  std::set<std::vector<MethodKind>> orders;
  for (int order = 1; order <= 6; ++order) {
    const auto ordered = MethodsInOrder(methods, order, "P07");
    REQUIRE(ordered);
    orders.insert(*ordered);
    ++first[ordered->front()];
  }
  CHECK(orders.size() == 6);
  for (const MethodKind method : methods) CHECK(first[method] == 2);
  const auto drawn = *MethodsInOrder(methods, 0, "P07");
  CHECK(drawn == *MethodsInOrder(methods, 0, "P07"));
  CHECK(orders.contains(drawn));
  for (const int wrong : {7, -1}) {
    CHECK_THAT(MethodsInOrder(methods, wrong, "P07").error().text,
               Catch::StartsWith(fmt::format("--order {}", wrong)));
  }
}

TEST_CASE("a study has a method for each maze, the mapping task one of its own", "[mapping_task]") {
  TaskOptions options = Good();
  CHECK(MethodOf(options, 2) == MethodKind::kMapping);
  CHECK(FolderOf(options) == "runs/mapping-P07");
  options.methods = {kOrder.rbegin(), kOrder.rend()};
  CHECK(MethodOf(options, 1) == MethodKind::kTeleop);
  CHECK(FolderOf(options) == "runs/study-P07");
  CHECK(DesignOf(options)["methods"][0] == "teleop");
  options.out = "data/x";
  CHECK(FolderOf(options) == "data/x");
}

TEST_CASE("impossible options are rejected by the option and its value", "[mapping_task]") {
  using O = TaskOptions;
  for (const auto& [set, named] : std::vector<std::pair<void (*)(O&), std::string>>{
           {[](O&) {}, ""},  // accepted
           {[](O& o) { o.participant = "a_B-9" + std::string(35, 'x'); }, ""},
           {[](O& o) { o.participant = std::string(41, 'x'); }, "--participant 'x"},
           {[](O& o) { o.participant = ""; }, "--participant ''"},
           {[](O& o) { o.participant = "../P07"; }, "--participant '../P07'"},
           {[](O& o) { o.participant = "P\xC3\xA9"; }, "--participant 'P"},
           {[](O& o) { o.participant = "no name"; }, "--participant 'no name'"},
           {[](O& o) { o.mazes = 0; }, "--mazes 0"},
           {[](O& o) { o.mazes = 101; }, "--mazes 101"},
           {[](O& o) { o.maze_seeds.assign(2, 7); }, "--maze-seed"},  // for 3 mazes
           {[](O& o) { o.speed = 0.0; }, "--speed 0"},
           {[](O& o) { o.speed = std::nan(""); }, "--speed nan"},
           {[](O& o) { o.camera = "film"; }, "--camera film"},
           {[](O& o) { o.preset = "nowhere"; }, "--preset nowhere"}}) {
    O options = Good();
    set(options);
    const auto valid = Validate(options);
    INFO("expected: " << named);
    CHECK(valid.has_value() == named.empty());
    if (!valid) CHECK_THAT(valid.error().text, Catch::StartsWith(named));
  }
}

template <class Config>
Config Read(const std::map<std::string, std::string>& plan, const std::string& service) {
  Config config;
  ReadConfig(YAML::Load(plan.at(service))[service]["ros__parameters"], service, config);
  return config;
}

constexpr MethodKind kOurs = MethodKind::kIgMcts;

std::map<std::string, std::string> Plan(std::vector<MethodKind> methods = {}) {
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
  CHECK(planner.method == MethodKind::kMapping);
  CHECK(planner.decision_file.empty());
  const auto service = Read<operators::OperatorConfig>(plan, "operator");
  CHECK(service.console.port == 8123);
  CHECK(service.recording.session == "P07-maze2-4");
  CHECK(service.recording.mazes == std::vector<std::string>{"w1=conav13@99"});
  CHECK(service.recording.pictures);
  CHECK(service.task.kind == "mapping");
  CHECK(service.task.earlier == std::vector<double>{0.25});
  CHECK(service.task.result == "/data/P07/maze-2-4/result.json");
}

TEST_CASE("the services of a study's part have its method, and stream where that needs it",
          "[mapping_task]") {
  const auto teleop = Plan({kOurs, MethodKind::kTeleop, MethodKind::kInstruction});
  CHECK(Read<sim::SimConfig>(teleop, "sim").camera.stream);
  CHECK(Read<planner::PlannerConfig>(teleop, "planner").method == MethodKind::kTeleop);
  CHECK(Read<operators::OperatorConfig>(teleop, "operator").method == MethodKind::kTeleop);
  CHECK(Read<operators::OperatorConfig>(teleop, "operator").task.kind == "study");
  const auto ours = Plan({MethodKind::kTeleop, kOurs, MethodKind::kInstruction});
  CHECK_FALSE(Read<sim::SimConfig>(ours, "sim").camera.stream);
  CHECK(Read<planner::PlannerConfig>(ours, "planner").perception_model ==
        PerceptionModelKind::kNhpm);
}

TEST_CASE("the report of a task counts the mazes that are finished and good enough to keep",
          "[mapping_task]") {
  TaskOptions options = Good();
  options.maze_seeds = {7, 9, 11};
  const auto result = [](double accuracy) {
    return MazeResult{accuracy, {{"participant", "P07"}, {"mapping_accuracy", accuracy}}};
  };
  const auto json = TaskJson(options, {result(0.75), result(0.5)});
  CHECK(json["participant"] == "P07");
  CHECK(json["complete"] == false);
  CHECK(json["mazes_wanted"] == 3);
  CHECK(json["mazes_finished"] == 2);
  CHECK(json["mazes_valid"] == 1);
  CHECK(json["mean_mapping_accuracy"] == 0.625);
  CHECK(json["mazes"][0]["seed"] == 7);
  CHECK_FALSE(json["mazes"][0].contains("participant"));
  CHECK(json["mazes"][1]["valid"] == false);  // 50 % is not enough
  CHECK(TaskJson(options, {result(1), result(1), result(1)})["complete"] == true);
  CHECK(TaskJson(options, {})["mean_mapping_accuracy"] == 0.0);
  CHECK_THAT(MazeLine(2, result(0.734)), Catch::Contains("maze 2") && Catch::Contains("73.4 %"));
  CHECK_THAT(MazeLine(2, result(0.5)), Catch::Contains("not valid"));
}

TEST_CASE("a maze's result is read back, another file is refused by its name", "[mapping_task]") {
  const test::TemporaryFolder folder;
  const auto file = folder / "result.json";
  const auto none = ReadMazeResult(file);
  REQUIRE(none);
  CHECK_FALSE(none->has_value());
  REQUIRE(WriteFile(file, R"({"mapping_accuracy": 0.75})"));
  const auto result = ReadMazeResult(file);
  REQUIRE((result && *result));
  CHECK((*result)->mapping_accuracy == 0.75);
  for (const char* text : {"", "[]", "{}", R"({"mapping_accuracy": "good"})"}) {
    REQUIRE(WriteFile(file, text));
    test::CheckRefusal(ReadMazeResult(file), Catch::Contains("result.json"), ErrorCode::kMalformed);
  }
}

}  // namespace
}  // namespace conav::mapping_task
