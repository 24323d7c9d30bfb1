#include "operator/recording/segment_collector.h"

#include <catch2/catch.hpp>

#include "common/segments/segment_checks.h"
#include "unit/operator/support/drawn_map.h"

namespace conav::operators {
namespace {

using namespace std::chrono_literals;

const std::vector<std::string> kMap = {"######", "#  # #", "# ## #", "#    #", "######"};

/// A session of world w1 in which each step takes a second, unless said otherwise.
struct Session {
  Session() {
    collector.Begin(belief, clock.Now());
    Robot("r1");
    Robot("r2");
  }

  void Robot(const std::string& name, std::int64_t stamp = 1) {
    RobotState state;
    state.stamp = {stamp};
    state.world = "w1";
    state.robot = name;
    state.goals_total = 4;
    collector.Receive(state);
  }
  Snapshot Taken(const std::string& robot, std::uint64_t sequence_number) const {
    Snapshot picture;
    picture.world = "w1";
    picture.robot = robot;
    picture.sequence_number = sequence_number;
    picture.cell = {1, 2};
    picture.heading_rad = 1.5;
    picture.visible = {{{1, 2}}, {{0, 2}}};
    picture.path = {{1, 1}, {1, 2}};
    picture.goals_left = {{3, 1}, {3, 4}, {1, 4}};
    picture.jpeg = {1, 2, 3};
    return picture;
  }
  void Send(const std::string& robot, std::uint64_t sequence_number,
            std::chrono::nanoseconds after = 1s) {
    clock.Advance(after);
    collector.Receive(Taken(robot, sequence_number), clock.Now());
  }
  void Edit(Cell cell, std::chrono::nanoseconds after = 1s) {
    clock.Advance(after);
    float& wall = belief.wall_probability[cell];
    wall = wall < 0.5F ? 1.0F : 0.0F;
    collector.Edited(belief, clock.Now());
  }
  void Answer(const std::string& robot, std::uint64_t sequence_number,
              std::chrono::nanoseconds after = 1s) {
    clock.Advance(after);
    Guidance guidance;
    guidance.world = "w1";
    guidance.robot = robot;
    guidance.answers_snapshot = sequence_number;
    collector.Guided(guidance, clock.Now());
  }
  /// The only completed segment; it passes all checks.
  RecordedSegment Only() {
    auto done = collector.Take();
    REQUIRE(done.size() == 1);
    const auto checked = CheckSegment(done[0].segment);
    CHECK(checked.has_value());
    return done[0];
  }

  FakeClock clock;
  Belief belief{{0}, "w1", 0, DrawnMap(kMap), ""};
  SegmentCollector collector{{SegmentOrigin::kPerson, "p07", "s1"}, {{"w1", {"conav13", 7, 9}}}};
};

std::vector<Cell> Edits(const Segment& segment) {
  std::vector<Cell> cells;
  for (std::size_t i = 0; i < segment.belief_after.size(); ++i) {
    if (segment.belief_after.values()[i] == segment.query.belief.values()[i]) continue;
    cells.push_back(segment.belief_after.CellAt(i));
  }
  return cells;
}

TEST_CASE("The pixels of a picture are moved into its segment", "[operator][recording]") {
  Session session;
  Snapshot picture = session.Taken("r1", 1);
  const std::uint8_t* pixels = picture.jpeg.data();
  session.collector.Receive(std::move(picture), session.clock.Now());
  session.Answer("r1", 1);
  const auto done = session.collector.Take();
  REQUIRE(done.size() == 1);
  CHECK(done[0].jpeg.data() == pixels);
}

TEST_CASE("A picture, an edit and its answer are a segment", "[operator][recording]") {
  Session session;
  session.Send("r1", 1);
  session.Edit({1, 1});
  CHECK(session.collector.Take().empty());
  session.Answer("r1", 1);
  const RecordedSegment done = session.Only();
  const Segment& segment = done.segment;
  CHECK(Edits(segment) == std::vector<Cell>{{1, 1}});
  CHECK(segment.query.belief == DrawnMap(kMap));
  CHECK(segment.query.path == std::vector<Cell>{{1, 1}, {1, 2}});
  CHECK(segment.query.cell == Cell{1, 2});
  CHECK(segment.query.heading_rad == 1.5);
  CHECK(segment.query.visible == VisibleCells{{{1, 2}}, {{0, 2}}});
  CHECK(segment.sent_s == 1.0);
  CHECK(segment.first_edit_s == 2.0);
  CHECK(segment.confirmed_s == 3.0);
  CHECK(segment.goals_reached == 1);
  CHECK(done.world == "w1");
  CHECK(done.robot == "r1");
  CHECK(done.sequence_number == 1);
  CHECK(done.jpeg == std::vector<std::uint8_t>{1, 2, 3});
}

TEST_CASE("What is known of session and maze stands with each segment", "[operator][recording]") {
  Session session;
  session.Send("r1", 1);
  session.Answer("r1", 1);
  const Trajectory trajectory = session.Only().trajectory;
  CHECK(trajectory.origin == SegmentOrigin::kPerson);
  CHECK(trajectory.participant == "p07");
  CHECK(trajectory.session == "s1");
  CHECK(trajectory.world == "conav13");
  CHECK(trajectory.world_seed == 7);
  CHECK(trajectory.corruption_seed == 9);
  CHECK_FALSE(trajectory.truth);
}

TEST_CASE("An answer without an edit is a segment without edits", "[operator][recording]") {
  Session session;
  session.Send("r1", 1);
  session.Answer("r1", 1);
  const Segment segment = session.Only().segment;
  CHECK(EditCount(segment) == 0);
  CHECK_FALSE(segment.first_edit_s);
}

TEST_CASE("Steps count the segments of a world, whichever robot sent them",
          "[operator][recording]") {
  Session session;
  session.Send("r1", 1);
  session.Answer("r1", 1);
  CHECK(session.Only().segment.step == 0);
  session.Send("r2", 1);
  session.Answer("r2", 1);
  CHECK(session.Only().segment.step == 1);
}

TEST_CASE("An edit between an answer and the next picture belongs to neither",
          "[operator][recording]") {
  Session session;
  session.Send("r1", 1);
  session.Answer("r1", 1);
  session.Only();
  session.Edit({1, 1});
  session.Send("r1", 2);
  session.Edit({3, 3});
  session.Answer("r1", 2);
  CHECK(Edits(session.Only().segment) == std::vector<Cell>{{3, 3}});
}

TEST_CASE("An edit that overtakes its picture belongs to it", "[operator][recording]") {
  Session session;
  session.Edit({1, 1});
  session.Send("r1", 1, 100ms);
  session.Answer("r1", 1);
  const Segment segment = session.Only().segment;
  CHECK(Edits(segment) == std::vector<Cell>{{1, 1}});
  CHECK(segment.first_edit_s == segment.sent_s);
}

TEST_CASE("An edit that was followed by guidance is no answer to the next picture, however soon",
          "[operator][recording]") {
  Session session;
  session.Edit({1, 1});
  session.Answer("r1", 0, 10ms);  // a blocked robot was sent another way
  session.Send("r1", 1, 10ms);
  session.Answer("r1", 1);
  CHECK(EditCount(session.Only().segment) == 0);
}

TEST_CASE("An answer that overtakes its picture waits for it", "[operator][recording]") {
  Session session;
  session.Send("r1", 1);
  session.Answer("r1", 1);
  session.Only();
  session.Edit({1, 1}, 1ms);
  session.Answer("r1", 2, 1ms);
  session.Edit({3, 3}, 1ms);
  CHECK(session.collector.Take().empty());
  session.Send("r1", 2, 1ms);
  const Segment segment = session.Only().segment;
  CHECK(Edits(segment) == std::vector<Cell>{{1, 1}});
  CHECK(segment.confirmed_s == segment.sent_s);
}

TEST_CASE("With two pictures open an edit belongs to the one answered next",
          "[operator][recording]") {
  Session session;
  session.Send("r1", 1);
  session.Send("r2", 1);
  session.Edit({1, 1});
  session.Answer("r1", 1);
  const RecordedSegment first = session.Only();
  CHECK(first.robot == "r1");
  CHECK(Edits(first.segment) == std::vector<Cell>{{1, 1}});
  session.Edit({3, 3});
  session.Answer("r2", 1);
  const RecordedSegment second = session.Only();
  CHECK(second.robot == "r2");
  CHECK(Edits(second.segment) == std::vector<Cell>{{3, 3}});
}

TEST_CASE("Guidance that answers no picture takes no edit from the open ones",
          "[operator][recording]") {
  Session session;
  session.Send("r1", 1);
  session.Edit({1, 1});
  session.Answer("r2", 0);
  session.Edit({3, 3});
  session.Answer("r1", 1);
  const Segment segment = session.Only().segment;
  CHECK(Edits(segment) == std::vector<Cell>{{1, 1}, {3, 3}});
  CHECK(segment.first_edit_s == 2.0);
}

TEST_CASE("The first edit of a picture is the first since it came", "[operator][recording]") {
  Session session;
  session.Edit({3, 3});
  session.Send("r1", 1);
  session.Edit({1, 1});
  session.Answer("r1", 1);
  const Segment segment = session.Only().segment;
  CHECK(Edits(segment) == std::vector<Cell>{{1, 1}});
  CHECK(segment.first_edit_s == 3.0);
}

TEST_CASE("A picture without an answer ends with the robot's next one", "[operator][recording]") {
  Session session;
  session.Send("r1", 1);
  session.Edit({1, 1});
  session.Send("r1", 2);
  const Segment first = session.Only().segment;
  CHECK(Edits(first) == std::vector<Cell>{{1, 1}});
  CHECK_FALSE(first.confirmed_s);
  session.Answer("r1", 2);
  CHECK(EditCount(session.Only().segment) == 0);
}

TEST_CASE("Streamed and repeated pictures, and those answered before, open nothing",
          "[operator][recording]") {
  Session session;
  Snapshot streamed = session.Taken("r1", 1);
  streamed.streamed = true;
  session.collector.Receive(streamed, session.clock.Now());
  session.Answer("r1", 1);
  CHECK(session.collector.Take().empty());
  session.Send("r1", 2);
  session.Answer("r1", 2);
  session.Only();
  session.Send("r1", 2);
  session.collector.Skip("r2", 5);
  session.Send("r2", 5);
  session.collector.End();
  CHECK(session.collector.Take().empty());
}

TEST_CASE("At the end an open picture counts only with an edit", "[operator][recording]") {
  Session edited;
  edited.Send("r1", 1);
  edited.Edit({1, 1});
  edited.collector.End();
  CHECK(Edits(edited.Only().segment) == std::vector<Cell>{{1, 1}});
  Session untouched;
  untouched.Send("r1", 1);
  untouched.collector.End();
  CHECK(untouched.collector.Take().empty());
}

TEST_CASE("Who finishes has looked at the open picture, with an edit or without",
          "[operator][recording]") {
  Session edited;
  edited.Send("r1", 1);
  edited.Edit({1, 1});
  edited.clock.Advance(2s);
  edited.collector.Finish(edited.clock.Now());
  const Segment segment = edited.Only().segment;
  CHECK(Edits(segment) == std::vector<Cell>{{1, 1}});
  CHECK(segment.confirmed_s == 4.0);
  Session untouched;
  untouched.Send("r1", 1);
  untouched.collector.Finish(untouched.clock.Now());
  CHECK(Edits(untouched.Only().segment).empty());
  untouched.collector.Finish(untouched.clock.Now());
  CHECK(untouched.collector.Take().empty());
}

TEST_CASE("A robot that starts anew counts its pictures anew", "[operator][recording]") {
  Session session;
  session.Robot("r1", 100);
  session.Send("r1", 7);
  session.Robot("r1", 3);
  session.Send("r1", 1);
  session.Answer("r1", 1);
  CHECK(session.Only().sequence_number == 1);
}

TEST_CASE("Accuracies are measured where the true map is known", "[operator][recording]") {
  Session session;
  OccupancyGrid truth(5, 6, Occupancy::kOccupied);
  for (int row = 1; row < 4; ++row) {
    for (int column = 1; column < 5; ++column) {
      truth[{row, column}] =
          DrawnMap(kMap)[{row, column}] != 0.0F ? Occupancy::kOccupied : Occupancy::kFree;
    }
  }
  truth[{1, 1}] = Occupancy::kOccupied;  // the operator's map is wrong in two cells
  truth[{3, 3}] = Occupancy::kOccupied;
  session.collector.SetTruth("w1", truth);
  session.Send("r1", 1);
  session.Edit({1, 1});
  session.Answer("r1", 1);
  const Trajectory trajectory = session.Only().trajectory;
  CHECK(trajectory.truth == truth);
  CHECK(trajectory.initial_cell_accuracy == Approx(10.0 / 12.0));
  CHECK(trajectory.final_cell_accuracy == Approx(11.0 / 12.0));
  CHECK(trajectory.final_mapping_accuracy == Approx(0.5));
}

TEST_CASE("A true map of another size is left out", "[operator][recording]") {
  Session session;
  session.collector.SetTruth("w1", OccupancyGrid(3, 3, Occupancy::kFree));
  session.Send("r1", 1);
  session.Answer("r1", 1);
  CHECK_FALSE(session.Only().trajectory.truth);
}

TEST_CASE("Even odds count as a wall", "[operator][recording]") {
  Session session;
  session.belief.wall_probability[{1, 1}] = 0.5F;
  session.collector.Edited(session.belief, session.clock.Now());
  session.Send("r1", 1);
  session.Answer("r1", 1);
  CHECK(session.Only().segment.query.belief[{1, 1}] == 1.0F);
}

TEST_CASE("Mazes are named with world, preset and seed", "[operator][recording]") {
  const auto facts = ParseMazeFacts({"w1=conav13@7", "w2=/maps/a=b.yaml", "w3=/maps/x@2@11"});
  REQUIRE(facts);
  CHECK(facts->at("w1").name == "conav13");
  CHECK(facts->at("w1").world_seed == 7);
  CHECK(facts->at("w1").corruption_seed == 7);
  CHECK(facts->at("w2").name == "/maps/a=b.yaml");
  CHECK(facts->at("w2").world_seed == 0);
  CHECK(facts->at("w3").name == "/maps/x@2");
  for (const char* bad : {"", "w1", "=conav13", "w1=conav13@", "w1=conav13@x", "w1=conav13@-1"}) {
    const auto refused = ParseMazeFacts({bad});
    REQUIRE_FALSE(refused);
    CHECK_THAT(refused.error().text, Catch::Contains(bad));
  }
}

}  // namespace
}  // namespace conav::operators
