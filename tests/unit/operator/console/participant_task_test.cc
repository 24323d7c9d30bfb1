#include "operator/console/participant_task.h"

#include <yaml-cpp/yaml.h>

#include <catch2/catch.hpp>
#include <fstream>

#include "support/drawn_map.h"
#include "support/temporary_folder.h"

namespace conav::operators {
namespace {

const std::vector<std::string> kTruth = {"######", "#    #", "# ## #", "#    #", "######"};
/// Two walls are missing.
const std::vector<std::string> kMap = {"######", "#    #", "#    #", "#    #", "######"};

OccupancyGrid TrueMaze() { return ToOccupancy(DrawnMap(kTruth)); }

RobotState StateOf(const std::string& robot, std::size_t goals_left) {
  return {.robot = robot,
          .goals_left = std::vector<Cell>(goals_left, {1, 4}),
          .goals_total = 4,
          .snapshots = 5};
}

struct Bench {
  Bench() {
    task.Receive(TrueMaze());
    task.Receive(StateOf("r1", 0));
    task.Begin();
    belief.wall_probability = initial;
  }

  ParticipantTask task{{"r1"}};
  BeliefGrid initial = DrawnMap(kMap);
  Belief belief;
};

TaskOptions Read(const std::string& yaml) {
  TaskOptions options;
  ReadConfig(YAML::Load(yaml), "operator.task", options);
  return options;
}

TEST_CASE("a task waits, runs from its beginning on, and is over when it is finished",
          "[operator][task]") {
  ParticipantTask task({"r1"});
  CHECK(task.phase() == TaskPhase::kWaiting);
  task.Begin();
  CHECK(task.phase() == TaskPhase::kRunning);
  task.Finish();
  task.Begin();
  CHECK(task.phase() == TaskPhase::kFinished);
}

TEST_CASE("a maze may be finished when all robots have reached all goals and the truth is known",
          "[operator][task]") {
  ParticipantTask task({"r1", "r2"});
  CHECK_THAT(task.CheckFinish(), Catch::Contains("not begun"));
  task.Begin();
  CHECK_THAT(task.CheckFinish(), Catch::Contains("not reported"));
  task.Receive(StateOf("r1", 1));
  task.Receive(StateOf("r2", 1));
  task.Receive(StateOf("stranger", 3));
  CHECK_THAT(task.CheckFinish(), Catch::Contains(" 2 "));
  task.Receive(StateOf("r1", 0));
  CHECK_THAT(task.CheckFinish(), Catch::Contains(" 1 "));
  CHECK(task.sums().goals_left == 1);
  CHECK(task.sums().images == 10);
  task.Receive(StateOf("r2", 0));
  CHECK_THAT(task.CheckFinish(), Catch::Contains("true maze"));
  task.Receive(TrueMaze());
  CHECK(task.CheckFinish().empty());
}

TEST_CASE("the result counts the corrected mistakes of the map", "[operator][task]") {
  Bench bench;
  bench.belief.revision = 3;
  bench.belief.wall_probability[{2, 2}] = 1.0F;  // right
  const auto half = bench.task.Measure(bench.belief, bench.initial);
  REQUIRE(half);
  CHECK(half->mapping_accuracy == 0.5);
  CHECK(half->wrong_at_first == 2);
  CHECK(half->corrected == 1);
  CHECK(half->broken == 0);
  CHECK(half->initial_cell_accuracy == Approx(10.0 / 12.0));
  CHECK(half->cell_accuracy == Approx(11.0 / 12.0));
  CHECK(half->edits == 3);
  bench.belief.wall_probability[{1, 1}] = 1.0F;  // wrong
  const auto none = bench.task.Measure(bench.belief, bench.initial);
  REQUIRE(none);
  CHECK(none->mapping_accuracy == 0.0);
  CHECK(none->broken == 1);
}

TEST_CASE("nothing is measured without the truth, or of maps that do not belong together",
          "[operator][task]") {
  Bench bench;
  const auto early = ParticipantTask({"r1"}).Measure(bench.belief, bench.initial);
  REQUIRE_FALSE(early);
  CHECK(early.error().code == ErrorCode::kRefused);
  bench.belief.wall_probability = BeliefGrid(3, 3);
  const auto other = bench.task.Measure(bench.belief, bench.initial);
  REQUIRE_FALSE(other);
  CHECK_THAT(other.error().text, Catch::Contains("another size"));
}

TEST_CASE("a participant edits until the end, and commands the robot only in a study",
          "[operator][task]") {
  const auto [kind, body, allowed, allowed_after] =
      GENERATE(table<TaskKind, decltype(OperatorRequest::body), bool, bool>({
          {TaskKind::kStudy, GuideRequest{}, true, false},
          {TaskKind::kStudy, DriveRequest{}, true, false},
          {TaskKind::kStudy, EditRequest{}, true, false},
          {TaskKind::kMapping, EditRequest{}, true, false},
          {TaskKind::kMapping, AnswerRequest{}, true, false},
          {TaskKind::kMapping, SelectRequest{}, true, true},
          {TaskKind::kMapping, GuideRequest{}, false, false},
          {TaskKind::kMapping, DriveRequest{}, false, false},
      }));
  CAPTURE(static_cast<int>(kind), body.index());
  const OperatorRequest request{.body = body};
  ParticipantTask task({"r1"}, kind);
  task.Begin();
  CHECK(task.CheckAllowed(request).empty() == allowed);
  task.Finish();
  CHECK(task.CheckAllowed(request).empty() == allowed_after);
  CHECK_FALSE(task.CheckFinish().empty());
}

TEST_CASE("a pause refuses everything but stops and notes", "[operator][task]") {
  ParticipantTask task({"r1"}, TaskKind::kStudy);
  task.Begin();
  task.SetPaused(true);
  CHECK_FALSE(task.CheckAllowed({.body = EditRequest{}}).empty());
  CHECK_FALSE(task.CheckAllowed({.body = ResumeRequest{}}).empty());
  CHECK_FALSE(task.CheckAllowed({.body = FinishRequest{}}).empty());
  CHECK(task.CheckAllowed({.body = StopRequest{}}).empty());
  CHECK(task.CheckAllowed({.body = NoteRequest{"calm"}}).empty());
  task.SetPaused(false);
  CHECK(task.CheckAllowed({.body = EditRequest{}}).empty());
}

TEST_CASE("what of a step outlives the service comes back as it was", "[operator][task]") {
  const StepProgress progress{.began_at_s = 1e9,
                              .saved_at_s = 1e9 + 20.0,
                              .used_s = 12.5,
                              .paused_s = 3.0,
                              .pauses = 2,
                              .paused = true,
                              .resume = {"r1", "r2"},
                              .guidance = 4,
                              .answers = R"({"age":41})",
                              .log = {{1e9, "note", "tired"}, {1e9 + 1, "paused", ""}}};
  const auto back = ParseStepProgress(ToText(progress));
  REQUIRE(back);
  CHECK(*back == progress);
  for (const char* text : {"", "[]", "{}", R"({"began_at": "now"})"}) {
    CAPTURE(text);
    CHECK(ParseStepProgress(text).error().code == ErrorCode::kMalformed);
  }
}

TEST_CASE("answers are one JSON object of a sensible size and depth", "[operator][task]") {
  CHECK(CheckedAnswers(R"( {"a": [1, {"b": "ü"}]} )") == R"({"a":[1,{"b":"ü"}]})");
  for (const std::string& json :
       {std::string(), std::string("[1]"), std::string("{"), std::string("3"),
        "{\"a\":" + std::string(40, '[') + std::string(40, ']') + "}",
        "{\"a\":\"" + std::string(300'000, 'x') + "\"}"}) {
    CAPTURE(json.substr(0, 20));
    CHECK(CheckedAnswers(json).error().code == ErrorCode::kMalformed);
  }
}

TEST_CASE("attention checks are found wherever questions are", "[operator][task]") {
  const test::TemporaryFolder folder;
  const auto file = folder / "trust.json";
  std::ofstream(file) << R"({"version": 3, "pages": [{"elements": [
      {"type": "panel", "elements": [{"name": "check", "attention": 2}]},
      {"name": "free", "type": "comment"}, {"name": "word", "attention": "blue"}]}]})";
  const auto form = ReadStudyForm(file);
  REQUIRE(form);
  CHECK(form->name == "trust");
  CHECK(form->version == "3");
  CHECK(AttentionPassed(*form, R"({"check":2,"word":"blue"})") == true);
  CHECK(AttentionPassed(*form, R"({"check":2,"word":"red"})") == false);
  CHECK(AttentionPassed(*form, R"({"word":"blue"})") == false);
  CHECK_FALSE(AttentionPassed({}, "{}"));
  std::ofstream(file) << "no form";
  CHECK(ReadStudyForm(file).error().code == ErrorCode::kMalformed);
  CHECK(ReadStudyForm(folder / "none.json").error().code == ErrorCode::kNotFound);
}

TEST_CASE("the words of a page are texts with the same gaps", "[operator][task]") {
  CHECK(ParsePageWords(R"({"Begin": "Los", "Step {} of {}": "{}/{}"})") ==
        PageWords{{"Begin", "Los"}, {"Step {} of {}", "{}/{}"}});
  for (const auto& [json, named] : {std::pair("[1]", "JSON object"),
                                    {"{", "JSON object"},
                                    {R"({"Begin": 3})", "'Begin'"},
                                    {R"({"": "x"})", "''"},
                                    {R"({"Step {}": "Schritt"})", "gaps"}}) {
    CAPTURE(json);
    CHECK_THAT(ParsePageWords(json).error().text, Catch::Contains(named));
  }
}

TEST_CASE("a task has a kind, one that cannot be is refused by its key", "[operator][task]") {
  CHECK_FALSE(Read("{}").on());
  CHECK(Read("{kind: study, result: result.json}").on());
  for (const auto& [yaml, key] : {std::pair("{kind: game, result: r.json}", "kind"),
                                  {"{kind: mapping}", "result"},
                                  {"{number: 3, count: 2}", "number"},
                                  {"{number: 0}", "number"},
                                  {"{earlier: [0.5, 1.5]}", "earlier"},
                                  {"{earlier: [.nan]}", "earlier"},
                                  {"{participant: a/b}", "participant"},
                                  {"{step: a_b}", "step"},
                                  {"{kind: form, result: r.json}", "form"},
                                  {"{kind: rest, result: r.json}", "rest_s"},
                                  {"{rotation: 360}", "rotation"}}) {
    CAPTURE(yaml);
    CHECK_THROWS_WITH(Read(yaml), Catch::Contains(std::string{"operator.task."} + key));
  }
}

}  // namespace
}  // namespace conav::operators
