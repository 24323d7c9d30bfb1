#include "operator/console/participant_task.h"

#include <yaml-cpp/yaml.h>

#include <catch2/catch.hpp>

#include "unit/operator/support/drawn_map.h"

namespace conav::operators {
namespace {

const std::vector<std::string> kTruth = {"######", "#    #", "# ## #", "#    #", "######"};
/// Two walls are missing.
const std::vector<std::string> kMap = {"######", "#    #", "#    #", "#    #", "######"};

OccupancyGrid TrueMaze() {
  const BeliefGrid drawn = DrawnMap(kTruth);
  OccupancyGrid maze(drawn.rows(), drawn.columns());
  for (std::size_t i = 0; i < maze.size(); ++i) {
    maze.values()[i] = drawn.values()[i] > 0.5F ? Occupancy::kOccupied : Occupancy::kFree;
  }
  return maze;
}

RobotState StateOf(const std::string& robot, std::size_t goals_left) {
  RobotState state;
  state.robot = robot;
  state.goals_left.assign(goals_left, Cell{1, 4});
  state.goals_total = 4;
  state.snapshots = 5;
  return state;
}

template <class Body>
OperatorRequest RequestOf(Body body) {
  OperatorRequest request;
  request.body = body;
  return request;
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

TEST_CASE("a maze may be finished when all robots have reached all goals", "[operator][task]") {
  ParticipantTask task({"r1", "r2"});
  task.Receive(TrueMaze());
  CHECK(task.CheckFinish() == "this maze has not begun yet: resume the robot first");
  task.Begin();
  CHECK(task.CheckFinish() == "the robot has not reported yet");
  task.Receive(StateOf("r1", 1));
  task.Receive(StateOf("r2", 1));
  task.Receive(StateOf("stranger", 3));
  CHECK(task.CheckFinish() == "the robot has 2 more goals to reach");
  task.Receive(StateOf("r1", 0));
  CHECK(task.CheckFinish() == "the robot has 1 more goal to reach");
  CHECK(task.goals_left() == 1);
  task.Receive(StateOf("r2", 0));
  CHECK(task.CheckFinish().empty());
}

TEST_CASE("without the true maze nothing can be finished", "[operator][task]") {
  ParticipantTask task({"r1"});
  task.Begin();
  task.Receive(StateOf("r1", 0));
  CHECK_THAT(task.CheckFinish(), Catch::Contains("true maze"));
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
  CHECK(half->snapshots == 5);
  CHECK(half->goals == 4);
  bench.belief.wall_probability[{1, 1}] = 1.0F;  // wrong
  const auto none = bench.task.Measure(bench.belief, bench.initial);
  REQUIRE(none);
  CHECK(none->mapping_accuracy == 0.0);
  CHECK(none->broken == 1);
}

TEST_CASE(
    "nothing is measured before all goals are reached, or of maps that do not belong together",
    "[operator][task]") {
  Bench bench;
  bench.task.Receive(StateOf("r1", 1));
  const auto early = bench.task.Measure(bench.belief, bench.initial);
  REQUIRE_FALSE(early);
  CHECK(early.error().code == ErrorCode::kRefused);
  bench.task.Receive(StateOf("r1", 0));
  bench.belief.wall_probability = BeliefGrid(3, 3);
  const auto other = bench.task.Measure(bench.belief, bench.initial);
  REQUIRE_FALSE(other);
  CHECK_THAT(other.error().text, Catch::Contains("another size"));
}

TEST_CASE("in a study the participant commands the robot, until the end", "[operator][task]") {
  ParticipantTask task({"r1"}, TaskKind::kStudy);
  task.Begin();
  CHECK(task.CheckAllowed(RequestOf(GuideRequest{})).empty());
  CHECK(task.CheckAllowed(RequestOf(DriveRequest{})).empty());
  CHECK(task.CheckAllowed(RequestOf(EditRequest{})).empty());
  task.Finish();
  CHECK(task.CheckAllowed(RequestOf(GuideRequest{})) == "this maze is finished");
  CHECK(task.CheckAllowed(RequestOf(DriveRequest{})) == "this maze is finished");
}

TEST_CASE("a participant edits and answers until the end, and never commands the robot",
          "[operator][task]") {
  Bench bench;
  CHECK(bench.task.CheckAllowed(RequestOf(EditRequest{})).empty());
  CHECK(bench.task.CheckAllowed(RequestOf(AnswerRequest{})).empty());
  CHECK_THAT(bench.task.CheckAllowed(RequestOf(GuideRequest{})), Catch::Contains("its own way"));
  CHECK_THAT(bench.task.CheckAllowed(RequestOf(DriveRequest{})), Catch::Contains("its own way"));
  bench.task.Finish();
  CHECK(bench.task.CheckAllowed(RequestOf(EditRequest{})) == "this maze is finished");
  CHECK(bench.task.CheckAllowed(RequestOf(AnswerRequest{})) == "this maze is finished");
  CHECK(bench.task.CheckAllowed(RequestOf(SelectRequest{})).empty());
  CHECK(bench.task.CheckFinish() == "this maze is finished");
}

TEST_CASE("without a kind there is no task", "[operator][task]") {
  CHECK_FALSE(Read("{}").on());
  CHECK(Read("{kind: study, result: result.json}").on());
}

TEST_CASE("a task that cannot be is refused by its key", "[operator][task]") {
  using Catch::Contains;
  CHECK_THROWS_WITH(Read("{kind: game, result: r.json}"), Contains("operator.task.kind"));
  CHECK_THROWS_WITH(Read("{kind: mapping}"), Contains("operator.task.result"));
  CHECK_THROWS_WITH(Read("{number: 3, count: 2}"), Contains("operator.task.number"));
  CHECK_THROWS_WITH(Read("{number: 0}"), Contains("operator.task.number"));
  CHECK_THROWS_WITH(Read("{earlier: [0.5, 1.5]}"), Contains("operator.task.earlier"));
  CHECK_THROWS_WITH(Read("{earlier: [.nan]}"), Contains("operator.task.earlier"));
  CHECK_THROWS_WITH(Read("{participant: a/b}"), Contains("operator.task.participant"));
}

}  // namespace
}  // namespace conav::operators
