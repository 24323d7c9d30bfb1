#include "operator/simulated/synthetic_operator.h"

#include <algorithm>
#include <catch2/catch.hpp>

#include "unit/operator/support/synthetic_fixture.h"

namespace conav::operators {
namespace {

using namespace std::chrono_literals;

TEST_CASE("The first path is given when belief and state are there", "[operator][simulated]") {
  Desk desk;
  desk.person.Receive(StateAt({1, 1}, 10));
  desk.ExpectNothing();
  desk.person.Receive(MapAt(0));
  const GuideRequest guide = desk.ExpectGuide();
  CHECK(guide.robot == "r1");
  CHECK(guide.path == std::vector<Cell>{{1, 1}, {1, 2}, {1, 3}, {1, 4}});
  CHECK(guide.answers_snapshot == 0);
  CHECK(guide.valid_for_s == 1800.0);
  desk.ExpectNothing();  // one request at a time
  desk.Accept(1);
  desk.ExpectNothing();
  CHECK(desk.person.counts().guidance == 1);
}

TEST_CASE("A picture that shows an error is answered by an edit, then by a path on the new map",
          "[operator][simulated]") {
  Desk desk;
  desk.Begin();
  desk.person.Receive(SnapshotOf(1, 20), desk.clock.Now());
  CHECK(desk.ExpectEdit() == EditRequest{0, {{{1, 3}, true}}});
  desk.Accept(1);
  desk.ExpectNothing();  // the edit counts only when the service has echoed it
  BeliefGrid edited = kMap;
  edited[{1, 3}] = 1.0F;
  desk.person.Receive(MapAt(1, edited));
  const GuideRequest guide = desk.ExpectGuide();
  CHECK(guide.answers_snapshot == 1);
  // Around the block: 7 steps instead of 2 and a crossing.
  CHECK(guide.path.size() == 8);
  CHECK(desk.person.counts().edits == 1);
}

TEST_CASE("A picture that shows no error is answered by a path alone", "[operator][simulated]") {
  Desk desk;
  desk.Begin();
  Snapshot picture = SnapshotOf(4, 20);
  picture.visible.walls.clear();
  desk.person.Receive(picture, desk.clock.Now());
  CHECK(desk.ExpectGuide().answers_snapshot == 4);
}

TEST_CASE("Somebody silent answers nothing", "[operator][simulated]") {
  Desk desk(ParametersOfKind("silent"));
  desk.person.Receive(MapAt(0));
  desk.person.Receive(StateAt({1, 1}, 10));
  desk.person.Receive(SnapshotOf(1, 20), desk.clock.Now());
  desk.ExpectNothing();
  CHECK(desk.person.open() == 0);
}

TEST_CASE("The kinds of people differ as their names say", "[operator][simulated]") {
  const auto careful = ParametersOfKind("careful");
  const auto hasty = ParametersOfKind("hasty");
  CHECK(careful.reader.edit_probability == PictureReaderParameters().edit_probability);
  CHECK(hasty.reader.edit_probability < careful.reader.edit_probability);
  CHECK(hasty.planner.horizon == "next_goal");
  CHECK(ParametersOfKind("wrong").reader.edit_probability == 0.0);
  CHECK(ParametersOfKind("wrong").planner.horizon == "away");
  CHECK(ParametersOfKind("silent").silent);
}

TEST_CASE("A config names the kind, and may change single values of it", "[operator][simulated]") {
  SyntheticOperatorParameters person;
  ReadConfig(YAML::Load("{kind: hasty, reader: {edit_limit: 5}}"), "person", person);
  CHECK(person.reader.edit_limit == 5);
  CHECK(person.planner.horizon == "next_goal");
  CHECK_THROWS_WITH(ReadConfig(YAML::Load("{kind: grumpy}"), "person", person),
                    Catch::Contains("person.kind") && Catch::Contains("careful"));
}

TEST_CASE("A picture newer than the state tells where the robot is", "[operator][simulated]") {
  Desk desk;
  desk.Begin();
  Snapshot picture = SnapshotOf(1, 20);
  picture.visible = {};
  picture.cell = {3, 1};
  picture.goals_left = {{3, 2}};
  desk.person.Receive(picture, desk.clock.Now());
  CHECK(desk.ExpectGuide().path == std::vector<Cell>{{3, 1}, {3, 2}});
  desk.Accept(2);

  picture.sequence_number = 2;
  desk.person.Receive(StateAt({1, 3}, 25));
  desk.person.Receive(picture, desk.clock.Now());
  CHECK(desk.ExpectGuide().path == std::vector<Cell>{{1, 3}, {1, 4}});
}

TEST_CASE("When all goals are reached a picture is answered all the same",
          "[operator][simulated]") {
  Desk desk;
  desk.Begin();
  Snapshot picture = SnapshotOf(1, 20);
  picture.visible = {};
  picture.goals_left.clear();
  desk.person.Receive(picture, desk.clock.Now());
  CHECK(desk.ExpectGuide().path == std::vector<Cell>{{1, 1}});
}

TEST_CASE("A glance at a streamed picture edits and gives no path", "[operator][simulated]") {
  Desk desk;
  desk.Begin();
  desk.person.Receive(SnapshotOf(1, 20, true), desk.clock.Now());
  desk.ExpectEdit();
  desk.Accept(1);
  BeliefGrid edited = kMap;
  edited[{1, 3}] = 1.0F;
  desk.person.Receive(MapAt(1, edited));
  desk.ExpectNothing();
  CHECK(desk.person.open() == 0);
}

TEST_CASE("Only a share of streamed pictures is looked at", "[operator][simulated]") {
  SyntheticOperatorParameters parameters = Flawless();
  parameters.glance_rate = 0.3;
  Desk desk(parameters);
  desk.Begin();
  int edits = 0;
  for (std::uint64_t i = 1; i <= 2000; ++i) {
    desk.person.Receive(SnapshotOf(i, 20, true), desk.clock.Now());
    if (!desk.person.Next(desk.clock.Now())) continue;
    ++edits;
    desk.Accept(0);  // the map never changes here
  }
  CHECK(edits == Approx(600).margin(60));
}

TEST_CASE("A refused edit is made again on the new map, as far as it is still a change",
          "[operator][simulated]") {
  Desk desk;
  desk.Begin();
  Snapshot picture = SnapshotOf(1, 20);
  picture.visible.walls = {{1, 3}, {3, 2}};
  desk.person.Receive(picture, desk.clock.Now());
  CHECK(desk.ExpectEdit() == EditRequest{0, {{{1, 3}, true}, {{3, 2}, true}}});
  desk.Refuse(1);
  desk.clock.Advance(1s);
  desk.ExpectNothing();  // revision 1 has not arrived
  BeliefGrid edited = kMap;
  edited[{3, 2}] = 1.0F;  // somebody else did that
  desk.person.Receive(MapAt(1, edited));
  CHECK(desk.ExpectEdit() == EditRequest{1, {{{1, 3}, true}}});
}

TEST_CASE("Refused guidance is asked for again after ever longer pauses, and given up in the end",
          "[operator][simulated]") {
  SyntheticOperatorParameters parameters = Flawless();
  parameters.attempts = 3;
  Desk desk(parameters);
  desk.person.Receive(MapAt(0));
  desk.person.Receive(StateAt({1, 1}, 10));
  desk.ExpectGuide();
  desk.Refuse(0);
  desk.ExpectNothing();
  desk.clock.Advance(100ms);
  desk.ExpectGuide();
  desk.Refuse(0);
  desk.clock.Advance(199ms);
  desk.ExpectNothing();
  desk.clock.Advance(1ms);
  desk.ExpectGuide();
  desk.person.Answered(Fail(ErrorCode::kTimeout, "no reply"), desk.clock.Now());
  CHECK(desk.person.open() == 0);
  CHECK(desk.person.counts().given_up == 1);
  CHECK(desk.person.counts().newest_problem == "no reply");
}

TEST_CASE("A person takes the time to think", "[operator][simulated]") {
  SyntheticOperatorParameters parameters = Flawless();
  parameters.thinking_time_s = 3.0;
  Desk desk(parameters);
  desk.person.Receive(MapAt(0));
  desk.person.Receive(StateAt({1, 1}, 10));
  desk.ExpectNothing();
  desk.clock.Advance(2999ms);
  desk.ExpectNothing();
  desk.clock.Advance(1ms);
  desk.ExpectGuide();
}

TEST_CASE("Pictures that somebody answered before are left alone", "[operator][simulated]") {
  Desk desk;
  desk.Begin();
  Guidance guidance;
  guidance.world = "w1";
  guidance.robot = "r1";
  guidance.answers_snapshot = 3;
  desk.person.Receive(guidance);
  desk.person.Receive(SnapshotOf(3, 20), desk.clock.Now());
  desk.ExpectNothing();
  desk.person.Receive(SnapshotOf(4, 21), desk.clock.Now());
  desk.ExpectEdit();
}

TEST_CASE("Robots and worlds of others are ignored", "[operator][simulated]") {
  Desk desk;
  desk.Begin();
  desk.person.Receive(StateAt({1, 1}, 10, "r9"));
  RobotState elsewhere = StateAt({1, 1}, 10);
  elsewhere.world = "w2";
  desk.person.Receive(elsewhere);
  Snapshot picture = SnapshotOf(1, 20);
  picture.robot = "r9";
  desk.person.Receive(picture, desk.clock.Now());
  desk.ExpectNothing();
  CHECK(desk.person.open() == 0);
}

TEST_CASE("A robot outside of the map is answered with an empty path", "[operator][simulated]") {
  Desk desk;
  desk.person.Receive(MapAt(0));
  desk.person.Receive(StateAt({99, 1}, 10));
  CHECK(desk.ExpectGuide().path.empty());
  CHECK(desk.person.counts().newest_problem.find("(99,1)") != std::string::npos);
}

/// Edits of r1's pictures when r2's pictures come `r2_first` before or after.
std::vector<std::vector<CellEdit>> EditsOfR1(bool r2_first) {
  SyntheticOperatorParameters parameters = Flawless();
  parameters.reader.edit_probability = 0.5;
  Desk desk(parameters, {{"r1", "w1"}, {"r2", "w1"}});
  desk.person.Receive(MapAt(0));
  std::vector<std::vector<CellEdit>> edits;
  for (std::uint64_t i = 1; i <= 40; ++i) {
    Snapshot mine = SnapshotOf(i, 20, true);
    Snapshot other = mine;
    other.robot = "r2";
    for (const Snapshot& picture : r2_first ? std::vector{other, mine} : std::vector{mine, other}) {
      desk.person.Receive(picture, desk.clock.Now());
      const auto ask = desk.person.Next(desk.clock.Now());
      if (picture.robot == "r1") edits.emplace_back();
      if (!ask) continue;
      if (picture.robot == "r1") edits.back() = std::get<EditRequest>(ask->body).edits;
      desk.Accept(0);
    }
  }
  return edits;
}

TEST_CASE("What is made of a robot's pictures does not depend on other robots",
          "[operator][simulated]") {
  const auto edits = EditsOfR1(true);
  CHECK(edits == EditsOfR1(false));
  CHECK(std::count(edits.begin(), edits.end(), std::vector<CellEdit>{}) > 5);
  CHECK(std::count(edits.begin(), edits.end(), std::vector<CellEdit>{}) < 35);
}

}  // namespace
}  // namespace conav::operators
