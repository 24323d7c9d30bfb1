#include "study/live/session.h"

#include <catch2/catch.hpp>
#include <map>

#include "common/runtime/file.h"
#include "operator/config.h"
#include "operator/recording/config.h"
#include "planner/config.h"
#include "sim/config.h"
#include "support/refusal.h"
#include "support/temporary_folder.h"

namespace conav::live_study {
namespace {

Step Maze(MethodKind method) {
  Step step{.id = "m", .title = "Part 1 of 3", .kind = Part::Kind::kMaze};
  step.method = method;
  step.seed = 99;
  step.rotation_deg = 90;
  step.maze.robots = 2;
  step.maze.show_scores = true;
  step.maze.time_limit_s = 300.0;
  step.number = 2;
  return step;
}

Step Form() { return {.id = "end", .kind = Part::Kind::kForm, .form = "forms/end.json"}; }

ParticipantPlan PlanOf(std::vector<Step> steps) {
  ParticipantPlan plan;
  plan.participant = "P07";
  plan.protocol = "methods";
  plan.steps = std::move(steps);
  return plan;
}

class Plan {
 public:
  explicit Plan(const Step& step, const std::string& eye_tracker = "",
                const SessionOptions& options = {}) {
    ParticipantPlan plan = PlanOf({step});
    plan.eye_tracker = {eye_tracker, true};
    const StepSetting setting{.plan = plan,
                              .options = options,
                              .step = step,
                              .folder = {"/data/P07/02-m"},
                              .participant_folder = "/data/P07",
                              .forms = "/data",
                              .domain = 43,
                              .port = 8123,
                              .token_file = "",
                              .earlier = {0.25},
                              .completion_code = "abc"};
    for (const PlannedService& service : PlanStep(setting)) {
      configs_[service.name] = service.config;
    }
  }
  template <class Config>
  Config Read(const std::string& service) const {
    Config config;
    ReadConfig(YAML::Load(configs_.at(service))[service]["ros__parameters"], service, config);
    return config;
  }
  const std::map<std::string, std::string>& configs() const { return configs_; }

 private:
  std::map<std::string, std::string> configs_;
};

TEST_CASE("the services of a maze get configurations that their own structs read back",
          "[live_study]") {
  const Plan plan(Maze(MethodKind::kTeleop));
  CHECK(plan.configs().size() == 4);
  const auto recorder = plan.Read<recorder::RecorderConfig>("recorder");
  CHECK(recorder.file == "/data/P07/02-m/recording.mcap");
  CHECK(recorder.facts.at("method") == "teleop");
  const auto sim = plan.Read<sim::SimConfig>("sim");
  CHECK(sim.seed == 99);
  CHECK(sim.rotation_deg == 90);
  CHECK(sim.robots == std::vector<std::string>{"r1", "r2"});
  CHECK(sim.bus.domain_id == 43);
  CHECK(sim.camera.stream);
  CHECK(sim.checkpoint == "/data/P07/02-m/w1.checkpoint");
  CHECK(plan.Read<planner::PlannerConfig>("planner").method == MethodKind::kTeleop);
  CHECK(plan.Read<planner::PlannerConfig>("planner").robots.size() == 2);
  const auto service = plan.Read<operators::OperatorConfig>("operator");
  CHECK(service.console.port == 8123);
  CHECK(service.recording.session == "P07-m");
  CHECK(service.recording.mazes == std::vector<std::string>{"w1=conav13 rotated 90@99"});
  CHECK(service.task.kind == "study");
  CHECK(service.task.step == "m");
  CHECK(service.task.earlier == std::vector<double>{0.25});
  CHECK(service.task.time_limit_s == 300.0);
  CHECK(service.task.layout == "99");
  CHECK(service.task.tags);
  CHECK(service.task.result == "/data/P07/02-m/result.json");
}

TEST_CASE("only ig-mcts has no stream, and the mapping task a model of its own", "[live_study]") {
  CHECK_FALSE(Plan(Maze(MethodKind::kIgMcts)).Read<sim::SimConfig>("sim").camera.stream);
  const Plan mapping(Maze(MethodKind::kMapping));
  CHECK(mapping.Read<operators::OperatorConfig>("operator").task.kind == "mapping");
  CHECK(mapping.Read<planner::PlannerConfig>("planner").perception_model ==
        PerceptionModelKind::kGlpf);
}

TEST_CASE("a page runs without robots, with the eye tracker where there is one", "[live_study]") {
  const Plan plan(Form(), "tcp://127.0.0.1:50020");
  CHECK(plan.configs().size() == 3);
  CHECK_THAT(plan.configs().at("eye-tracker"), Catch::Contains("tcp://127.0.0.1:50020"));
  const auto service = plan.Read<operators::OperatorConfig>("operator");
  CHECK(service.robots.empty());
  CHECK(service.task.kind == "form");
  CHECK(service.task.form == "/data/forms/end.json");
  CHECK(service.task.completion_code == "abc");
  CHECK(service.recording.file.empty());
}

TEST_CASE("a remote participant's page listens as the options say", "[live_study]") {
  SessionOptions options;
  options.address = "0.0.0.0";
  options.insecure = true;
  options.public_url = "https://study.example.org";
  const auto console =
      Plan(Form(), "", options).Read<operators::OperatorConfig>("operator").console;
  CHECK(console.address == "0.0.0.0");
  CHECK(console.insecure);
  CHECK(console.origins == std::vector<std::string>{"https://study.example.org"});
}

TEST_CASE("impossible options are refused by the option and its value", "[live_study]") {
  using O = SessionOptions;
  for (const auto& [set, named] : std::vector<std::pair<void (*)(O&), std::string>>{
           {[](O&) {}, ""},  // accepted
           {[](O& o) { o.participant = "a_B-9" + std::string(35, 'x'); }, ""},
           {[](O& o) { o.participant = std::string(41, 'x'); }, "--participant 'x"},
           {[](O& o) { o.participant = ""; }, "--participant ''"},
           {[](O& o) { o.participant = "../P07"; }, "--participant '../P07'"},
           {[](O& o) { o.participant = "P\xC3\xA9"; }, "--participant 'P"},
           {[](O& o) { o.address = "0.0.0.0"; }, "0.0.0.0"},  // in clear
           {[](O& o) { o.tls.certificate = "c.pem"; }, "tls"},
           {[](O& o) { o.public_url = "study"; }, "study"},
           {[](O& o) { o.dds = "other"; }, "--dds other"}}) {
    O options;
    options.participant = "P07";
    set(options);
    const auto valid = Validate(options);
    INFO("expected: " << named);
    CHECK(valid.has_value() == named.empty());
    if (!valid) CHECK_THAT(valid.error().text, Catch::Contains(named));
  }
}

nlohmann::ordered_json Finished(double accuracy = 0.0) {
  return {{"participant", "P07"}, {"finished_at", 1.0}, {"mapping_accuracy", accuracy}};
}

TEST_CASE("training is repeated until the criterion is reached or attempts run out",
          "[live_study]") {
  Step first = Maze(MethodKind::kTeleop);
  first.training = true;
  first.criterion = {3, 0.5};
  Step second = first;
  second.attempt = 2;
  Step third = first;
  third.attempt = 3;
  const ParticipantPlan plan = PlanOf({first, second, third, Form()});
  Progress progress;
  CHECK(progress.Next(plan) == 0);
  progress.results[0] = Finished(0.4);
  CHECK(progress.Next(plan) == 1);
  SECTION("reached") {
    progress.results[1] = Finished(0.5);
    CHECK(progress.Next(plan) == 3);
    CHECK(ResultJson(plan, progress, "")["steps"][1]["criterion_reached"] == true);
  }
  SECTION("attempts run out") {
    progress.results[1] = Finished(0.3);
    progress.results[2] = Finished(0.3);
    CHECK(progress.Next(plan) == 3);
  }
  progress.results[3] = Finished();
  CHECK_FALSE(progress.Next(plan));
}

TEST_CASE("after an abort only the last page follows", "[live_study]") {
  const ParticipantPlan plan = PlanOf({Form(), Maze(MethodKind::kTeleop), Form()});
  Progress progress;
  progress.results[0] = Finished();
  progress.results[0]["aborted"] = true;
  CHECK(progress.Next(plan) == 2);
  progress.results[2] = Finished();
  CHECK_FALSE(progress.Next(plan));
  const auto json = ResultJson(plan, progress, "abc");
  CHECK(json["aborted"] == true);
  CHECK(json["complete"] == false);
  CHECK_FALSE(PlanOf({Form(), Maze(MethodKind::kTeleop)}).steps.empty());
}

TEST_CASE("the result has each finished step with its maze, and the code at the end",
          "[live_study]") {
  const ParticipantPlan plan = PlanOf({Maze(MethodKind::kTeleop), Form()});
  Progress progress;
  progress.results[0] = Finished(0.75);
  auto json = ResultJson(plan, progress, "abc");
  CHECK(json["complete"] == false);
  CHECK_FALSE(json.contains("completion_code"));
  const auto& maze = json["steps"][0];
  CHECK(maze["step"] == "m");
  CHECK(maze["folder"] == "01-m");
  CHECK(maze["method"] == "teleop");
  CHECK(maze["seed"] == 99);
  CHECK(maze["rotation"] == 90);
  CHECK(maze["training"] == false);
  CHECK_FALSE(maze.contains("participant"));
  progress.results[1] = Finished();
  json = ResultJson(plan, progress, "abc");
  CHECK(json["complete"] == true);
  CHECK(json["completion_code"] == "abc");
}

TEST_CASE("the mapping task counts the mazes that are good enough to keep", "[live_study]") {
  auto plan = *PlanMappingTask({"P07", 3, {7, 9, 11}});
  Progress progress;
  CHECK(ResultJson(plan, progress, "")["mean_mapping_accuracy"] == 0.0);
  progress.results[0] = Finished(0.75);
  progress.results[1] = Finished(0.5);
  const auto json = ResultJson(plan, progress, "");
  CHECK(json["mazes_wanted"] == 3);
  CHECK(json["mazes_finished"] == 2);
  CHECK(json["mazes_valid"] == 1);
  CHECK(json["mean_mapping_accuracy"] == 0.625);
  CHECK(json["steps"][1]["valid"] == false);  // 50 % is not enough
}

TEST_CASE("a step's result is read back, another file is refused by its name", "[live_study]") {
  const test::TemporaryFolder folder;
  const auto none = ReadStepResult(folder / "result.json");
  REQUIRE(none);
  CHECK_FALSE(none->has_value());
  const auto result = ReadStepResult(folder.Write("result.json", R"({"finished_at": 3})"));
  REQUIRE((result && *result));
  CHECK((**result)["finished_at"] == 3);
  CHECK(ReadStepResult(folder.Write("empty.json", "")).value() == std::nullopt);  // a power cut
  for (const char* text : {" ", "[]", "{}"}) {
    test::CheckRefusal(ReadStepResult(folder.Write("result.json", text)),
                       Catch::Contains("result.json"), ErrorCode::kMalformed);
  }
}

}  // namespace
}  // namespace conav::live_study
