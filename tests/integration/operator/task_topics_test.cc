#include "operator/console/task_topics.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <fstream>
#include <nlohmann/json.hpp>

#include "common/runtime/file.h"
#include "integration/operator/hand_made_sim.h"

namespace conav::operators {
namespace {

/// Two walls are missing.
const std::vector<std::string> kBareMap = {"######", "#    #", "#    #", "#    #", "######"};

struct TaskBench {
  TaskBench() {
    config = ConfigFor(folder / "operator.db");
    config.task.kind = "mapping";
    config.task.participant = "P07";
    config.task.result = (folder / "result.json").string();
    REQUIRE(truth.Publish(ToMessage(MapUpdate{{0}, 1.5, DrawnTruth(kMap)})));
  }

  /// The topics as the service has them, before the participant begins.
  void Start() {
    topics.reset();
    store.emplace(BeliefStoreOptions{{config.database, 0}, {}});
    topics.emplace(participant, config, *store, clock);
    REQUIRE(store->AddWorld("w1", ToBelief(DrawnTruth(kBareMap)), {}));
    topics->Step();
  }
  void Begin() { topics->Receive(ControlRegistry({{"r1", "w1"}}, {.start_stopped = false})); }
  void ReachAllGoals() {
    if (topics->status().phase == TaskPhase::kWaiting) Begin();
    topics->Receive(RobotState{.robot = "r1", .goals_total = 4, .snapshots = 6});
  }
  void Correct() {
    const OperatorRequest request{
        {}, "page", 1, std::string("w1"), EditRequest{0, {{{2, 2}, true}}}};
    REQUIRE(store->Handle(request, {}).reply.accepted);
  }
  BeliefStore::Answer Finish(std::uint64_t id = 9) {
    return topics->Finish({{}, "page", id, {}, FinishRequest{}});
  }
  /// A step without a robot. `form`: of a form, else a rest of a minute.
  void UseStep(const std::string& form = "") {
    config.robots = {};
    config.task.kind = form.empty() ? "rest" : "form";
    config.task.step = "step-1";
    config.task.rest_s = 60.0;
    config.task.form = (folder / "mood.json").string();
    std::ofstream(config.task.form) << form;
  }
  /// The step without a robot, as the service has it after a start.
  void StartStep() {
    topics.reset();
    store.reset();
    store.emplace(BeliefStoreOptions{{config.database, 0}, {}});
    topics.emplace(participant, config, *store, clock);
  }
  /// Why it is refused; empty = it is not.
  std::string Ask(StudyRequest::Kind kind, const std::string& text = "") {
    return topics->Answer({kind, text, "", "page", 1}).reason;
  }
  void Pass(std::chrono::seconds time) {
    clock.Advance(time);
    topics->Step();
  }
  /// Labels that were published since the call before.
  std::vector<std::string> Marks() {
    std::vector<std::string> labels;
    for (const auto& mark : marks.Take()) labels.push_back(mark.label());
    return labels;
  }
  nlohmann::json Result() const {
    return nlohmann::json::parse(ReadFile(folder / "result.json").value_or("null"));
  }

  TemporaryFolder folder;
  std::shared_ptr<bus::InMemoryBus> bus = std::make_shared<bus::InMemoryBus>();
  bus::Participant sim{"sim", bus};
  bus::Publisher<nav_msgs::msg::OccupancyGrid> truth{sim, bus::kTruth, "w1"};
  bus::Subscriber<conav_msgs::msg::StudyMark> marks{sim, bus::kStudyMark};
  bus::Participant participant{"operator", bus};
  FakeClock clock;
  OperatorConfig config;
  std::optional<BeliefStore> store;
  std::optional<TaskTopics> topics;
};

using Kind = StudyRequest::Kind;
using Labels = std::vector<std::string>;
using namespace std::chrono_literals;

ControlRegistry Driving() { return {{{"r1", "w1"}}, {.start_stopped = false}}; }

}  // namespace

TEST_CASE("a finished maze's result is on disk when it is acknowledged, and stays so",
          "[operator][task]") {
  TaskBench bench;
  bench.Start();
  bench.Correct();
  CHECK_FALSE(bench.Finish().reply.accepted);
  CHECK(bench.Result().is_null());
  bench.ReachAllGoals();
  CHECK(bench.topics->status().may_finish);
  const auto answer = bench.Finish(10);
  CHECK(answer.reply.accepted);
  CHECK(answer.changed);
  CHECK(bench.topics->status().mapping_accuracy == 0.5);
  const auto result = bench.Result();
  CHECK(result["participant"] == "P07");
  CHECK(result["mapping_accuracy"] == 0.5);
  CHECK(result["edits"] == 1);
  CHECK(result["pictures"] == 6);
  CHECK(result["goals_total"] == 4);
  CHECK(result["timed_out"] == false);
  const auto repeat = bench.Finish(10);
  CHECK(repeat.reply.accepted);
  CHECK_FALSE(repeat.changed);
  CHECK_FALSE(bench.Finish(4).reply.accepted);
  bench.store.reset();
  bench.topics.reset();
  bench.store.emplace(BeliefStoreOptions{{bench.config.database, 0}, {}});
  bench.topics.emplace(bench.participant, bench.config, *bench.store, bench.clock);
  CHECK(bench.topics->status().phase == TaskPhase::kFinished);
  CHECK(bench.topics->status().mapping_accuracy == 0.5);
}

TEST_CASE("a result that cannot be written is not acknowledged", "[operator][task]") {
  TaskBench bench;
  const auto results = bench.folder / "results";
  std::filesystem::create_directory(results);
  bench.config.task.result = (results / "result.json").string();
  bench.Start();
  bench.ReachAllGoals();
  std::filesystem::remove(results);
  const auto answer = bench.Finish();
  CHECK_FALSE(answer.reply.accepted);
  CHECK_THAT(answer.reply.reason, Catch::Contains("results"));
  CHECK_FALSE(bench.topics->finished());
  std::filesystem::create_directory(results);
  CHECK(bench.Finish().reply.accepted);
}

TEST_CASE("a task of two worlds, or whose result could not be written, does not start",
          "[operator][task]") {
  TaskBench unwritable;
  unwritable.config.task.result = (unwritable.folder / "nowhere" / "result.json").string();
  CHECK_THROWS_WITH(unwritable.Start(),
                    Catch::Contains("operator.task.result") && Catch::Contains("nowhere"));
  TaskBench bench;
  bench.config.robots = {"w1/r1", "w2/r2"};
  CHECK_THROWS_WITH(bench.Start(), Catch::Contains("w1 and w2"));
  bench.config.robots = {"w1/r1"};
  std::ofstream(bench.folder / "result.json") << "something else";
  CHECK_THROWS_WITH(bench.Start(), Catch::Contains("result.json"));
}

TEST_CASE("a task begins when a robot is resumed", "[operator][task]") {
  TaskBench bench;
  bench.Start();
  ControlRegistry control({{"r1", "w1"}}, {.start_stopped = true});
  bench.topics->Receive(control);
  CHECK(bench.topics->status().phase == TaskPhase::kWaiting);
  const auto orders = control.Resume("page", {}, {});
  REQUIRE(orders);
  for (const StopOrder& order : *orders) control.Adopt(order);
  bench.topics->Receive(control);
  CHECK(bench.topics->status().phase == TaskPhase::kRunning);
}

TEST_CASE("a form begins with the participant's page, and its draft outlives the service",
          "[operator][task]") {
  TaskBench bench;
  bench.UseStep(R"({"version": 2, "elements": [{"name": "check", "attention": "yes"}]})");
  bench.StartStep();
  bench.Pass(10s);
  CHECK(bench.topics->status().phase == TaskPhase::kWaiting);
  bench.topics->SetPresent(true);
  bench.Pass(1s);
  CHECK(bench.topics->status().phase == TaskPhase::kRunning);
  bench.Pass(20s);
  CHECK(bench.Ask(Kind::kDraft, R"({"age": 41})").empty());
  CHECK_FALSE(bench.Ask(Kind::kDraft, "no JSON").empty());

  bench.clock.Advance(3600s);  // the service is away
  bench.StartStep();
  CHECK(bench.topics->status().phase == TaskPhase::kRunning);
  CHECK(bench.topics->status().used_s == Approx(20.0));
  const auto updates = bench.topics->TakeUpdates();
  const auto draft = std::ranges::find_if(updates, &console::Update::has_draft);
  REQUIRE(draft != updates.end());
  CHECK(draft->draft().json() == R"({"age":41})");
  CHECK(bench.topics->TakeUpdates().empty());

  bench.Pass(5s);
  const std::string answers = R"({"age": 41, "check": "yes"})";
  CHECK(bench.Ask(Kind::kAnswers, answers).empty());
  const auto result = bench.Result();
  CHECK(result["kind"] == "form");
  CHECK(result["step"] == "step-1");
  CHECK(result["form"] == "mood");
  CHECK(result["version"] == 2);
  CHECK(result["answers"]["age"] == 41);
  CHECK(result["attention_passed"] == true);
  CHECK(result["duration_s"] == Approx(25.0));
  CHECK(result["aborted"] == false);
  CHECK_FALSE(std::filesystem::exists(bench.folder / "result.json.draft"));
  CHECK(bench.Marks() == Labels{"form begin", "pause begin", "pause end", "form end"});

  bench.StartStep();
  CHECK(bench.topics->finished());
  CHECK(bench.Ask(Kind::kAnswers, answers).empty());  // a repeat
  CHECK_FALSE(bench.Ask(Kind::kAnswers, R"({"age": 42})").empty());
  CHECK_FALSE(bench.Ask(Kind::kDraft, answers).empty());
}

TEST_CASE("a rest begins when it is asked for, and ends by itself after its time without pauses",
          "[operator][task]") {
  TaskBench bench;
  bench.UseStep();
  bench.StartStep();
  bench.topics->SetPresent(true);
  bench.Pass(100s);
  CHECK(bench.topics->status().phase == TaskPhase::kWaiting);
  CHECK(bench.Ask(Kind::kBegin).empty());
  CHECK(bench.Ask(Kind::kBegin).empty());
  bench.Pass(40s);
  CHECK(bench.Ask(Kind::kPause).empty());
  CHECK(bench.Ask(Kind::kPause).empty());
  CHECK(bench.topics->status().since_s == 0.0);
  bench.Pass(1000s);
  CHECK(bench.Ask(Kind::kContinue).empty());
  bench.Pass(19s);
  CHECK(bench.topics->status().phase == TaskPhase::kRunning);
  bench.Pass(1s);
  CHECK(bench.topics->finished());
  CHECK(bench.topics->TakeFinished());
  CHECK_FALSE(bench.topics->TakeFinished());
  const auto result = bench.Result();
  CHECK(result["duration_s"] == Approx(60.0));
  CHECK(result["paused_s"] == Approx(1000.0));
  CHECK(result["pauses"] == 1);
  CHECK(result["log"].size() == 3);
  CHECK(bench.Marks() == Labels{"baseline begin", "pause begin", "pause end", "baseline end"});
}

TEST_CASE("a pause stops the robots, and resumes those that drove", "[operator][task]") {
  TaskBench bench;
  bench.Start();
  bench.topics->Receive(Driving());
  CHECK(bench.Ask(Kind::kPause).empty());
  auto requests = bench.topics->TakeRequests();
  REQUIRE(requests.size() == 1);
  CHECK(std::holds_alternative<StopRequest>(requests[0].body));
  CHECK(bench.topics->CheckAllowed(requests[0]).empty());
  CHECK_FALSE(bench.topics->CheckAllowed({.client = "page", .body = ResumeRequest{}}).empty());
  CHECK_FALSE(bench.Finish().reply.accepted);

  SECTION("at once") {}
  SECTION("and after a restart, which stops them again") {
    bench.topics.emplace(bench.participant, bench.config, *bench.store, bench.clock);
    CHECK(bench.topics->status().paused);
    requests = bench.topics->TakeRequests();
    REQUIRE(requests.size() == 1);
    CHECK(std::holds_alternative<StopRequest>(requests[0].body));
  }
  CHECK(bench.Ask(Kind::kContinue).empty());
  requests = bench.topics->TakeRequests();
  REQUIRE(requests.size() == 1);
  CHECK(std::get<ResumeRequest>(requests[0].body).robots == std::vector<std::string>{"r1"});
}

TEST_CASE("an aborted step has a result that says why", "[operator][task]") {
  TaskBench bench;
  bench.config.task.training = true;
  bench.Start();
  bench.Begin();
  bench.topics->Receive(RobotState{.robot = "r1", .goals_total = 4, .cell_moves = 7});
  bench.topics->Receive(
      OperatorEvent{.kind = RequestKind::kNote, .client = "lead", .text = "feels unwell"});
  CHECK(bench.Ask(Kind::kAbort, "unwell").empty());
  CHECK(bench.Ask(Kind::kAbort, "unwell").empty());
  const auto result = bench.Result();
  CHECK(result["aborted"] == true);
  CHECK(result["reason"] == "unwell");
  CHECK(result["cell_moves"] == 7);
  CHECK(result["log"][1]["text"] == "feels unwell");
  CHECK(bench.Marks() == Labels{"training begin", "note", "aborted", "training end"});
  bench.topics.emplace(bench.participant, bench.config, *bench.store, bench.clock);
  CHECK(bench.topics->status().aborted);
  CHECK_FALSE(bench.Ask(Kind::kPause).empty());
}

TEST_CASE("a maze with a time limit ends by itself, goals or not", "[operator][task]") {
  TaskBench bench;
  bench.config.task.time_limit_s = 300.0;
  bench.config.method = MethodKind::kTeleop;
  bench.config.task.layout = "classic13";
  bench.Start();
  bench.Begin();
  bench.topics->Receive(RobotState{.robot = "r1",
                                   .goals_left = {{1, 4}},
                                   .goals_reached = {{3, 4}},
                                   .goals_total = 2,
                                   .low_level_steps = 90,
                                   .image_bytes = 5000});
  bench.Pass(299s);
  CHECK_FALSE(bench.topics->finished());
  bench.Pass(1s);
  CHECK(bench.topics->finished());
  const auto result = bench.Result();
  CHECK(result["timed_out"] == true);
  CHECK(result["method"] == "teleop");
  CHECK(result["layout"] == "classic13");
  CHECK(result["robots"] == 1);
  CHECK(result["goals_reached"] == 1);
  CHECK(result["goals_total"] == 2);
  CHECK(result["low_level_steps"] == 90);
  CHECK(result["image_bytes"] == 5000);
  CHECK(result["mapping_accuracy"] == 0.0);
}

TEST_CASE("a form that is none, and a draft that is none, do not start", "[operator][task]") {
  TaskBench bench;
  bench.UseStep("no form");
  CHECK_THROWS_WITH(bench.StartStep(), Catch::Contains("operator.task.form"));
  bench.UseStep("{}");
  std::ofstream(bench.folder / "result.json.draft") << "{}";
  CHECK_THROWS_WITH(bench.StartStep(), Catch::Contains("result.json.draft"));
}

}  // namespace conav::operators
