#include "operator/recording/segment_collector.h"

#include <fmt/core.h>

#include <catch2/catch.hpp>
#include <functional>

#include "common/grid/map_accuracy.h"
#include "common/segments/segment_checks.h"
#include "support/drawn_map.h"

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
    collector.Receive(RobotState{.stamp = {stamp}, .world = "w1", .robot = name, .goals_total = 4});
  }
  Snapshot Taken(const std::string& robot, std::uint64_t sequence_number) const {
    return {.world = "w1",
            .robot = robot,
            .sequence_number = sequence_number,
            .cell = {1, 2},
            .heading_rad = 1.5,
            .jpeg = {1, 2, 3},
            .visible = {{{1, 2}}, {{0, 2}}},
            .path = {{1, 1}, {1, 2}},
            .goals_left = {{3, 1}, {3, 4}, {1, 4}}};
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
    collector.Guided({.world = "w1", .robot = robot, .answers_snapshot = sequence_number},
                     clock.Now());
  }
  /// The only completed segment; it passes all checks.
  RecordedSegment Only() {
    auto done = collector.Take();
    REQUIRE(done.size() == 1);
    const auto checked = CheckSegment(done[0].segment);
    CHECK(checked.has_value());
    return std::move(done[0]);
  }

  FakeClock clock;
  Belief belief{{0}, "w1", 0, DrawnMap(kMap), ""};
  SegmentCollector collector{{SegmentOrigin::kPerson, "p07", "s1"}, {{"w1", {"conav13", 7, 9}}}};
};

/// A completed segment as "robot/picture edits sent/first edit/confirmed", for example
/// "r1/1 (1,1) 1/2/3".
std::string Summary(const RecordedSegment& done) {
  const Segment& segment = done.segment;
  std::string edits;
  for (std::size_t i = 0; i < segment.belief_after.size(); ++i) {
    if (segment.belief_after.values()[i] == segment.query.belief.values()[i]) continue;
    edits += fmt::format("{}", segment.belief_after.CellAt(i));
  }
  const auto time = [](const std::optional<double>& s) {
    return s ? fmt::format("{:.4g}", *s) : "-";
  };
  return fmt::format("{}/{} {} {}/{}/{}", done.robot, done.sequence_number,
                     edits.empty() ? "-" : edits, time(segment.sent_s), time(segment.first_edit_s),
                     time(segment.confirmed_s));
}

using Step = std::function<void(Session&)>;
Step Send(const std::string& robot, std::uint64_t number, std::chrono::nanoseconds after = 1s) {
  return [=](Session& session) { session.Send(robot, number, after); };
}
Step Edit(Cell cell, std::chrono::nanoseconds after = 1s) {
  return [=](Session& session) { session.Edit(cell, after); };
}
Step Answer(const std::string& robot, std::uint64_t number, std::chrono::nanoseconds after = 1s) {
  return [=](Session& session) { session.Answer(robot, number, after); };
}
Step Robot(const std::string& robot, std::int64_t stamp) {
  return [=](Session& session) { session.Robot(robot, stamp); };
}
void Stream(Session& session) {
  session.clock.Advance(1s);
  Snapshot streamed = session.Taken("r1", 1);
  streamed.streamed = true;
  session.collector.Receive(streamed, session.clock.Now());
}
void SkipFiveOfR2(Session& session) { session.collector.Skip("r2", 5); }
void Finish(Session& session) {
  session.clock.Advance(1s);
  session.collector.Finish(session.clock.Now());
}
void End(Session& session) { session.collector.End(); }

TEST_CASE("Pictures, edits and answers become segments", "[operator][recording]") {
  struct Row {
    const char* rule;
    std::vector<Step> steps;
    std::vector<std::string> segments;
  };
  const Cell a{1, 1}, b{3, 3};
  for (const Row& row : std::vector<Row>{
           {"a picture, an edit and its answer",
            {Send("r1", 1), Edit(a), Answer("r1", 1)},
            {"r1/1 (1,1) 1/2/3"}},
           {"an answer without an edit", {Send("r1", 1), Answer("r1", 1)}, {"r1/1 - 1/-/2"}},
           {"an edit between an answer and the next picture belongs to neither",
            {Send("r1", 1), Answer("r1", 1), Edit(a), Send("r1", 2), Edit(b), Answer("r1", 2)},
            {"r1/1 - 1/-/2", "r1/2 (3,3) 4/5/6"}},
           {"an edit that overtakes its picture belongs to it",
            {Edit(a), Send("r1", 1, 100ms), Answer("r1", 1)},
            {"r1/1 (1,1) 1.1/1.1/2.1"}},
           {"an edit followed by guidance (a blocked robot's) is no answer to the next picture",
            {Edit(a), Answer("r1", 0, 10ms), Send("r1", 1, 10ms), Answer("r1", 1)},
            {"r1/1 - 1.02/-/2.02"}},
           {"an answer that overtakes its picture waits for it",
            {Send("r1", 1), Answer("r1", 1), Edit(a, 1ms), Answer("r1", 2, 1ms), Edit(b, 1ms),
             Send("r1", 2, 1ms)},
            {"r1/1 - 1/-/2", "r1/2 (1,1) 2.004/2.004/2.004"}},
           {"with two pictures open an edit belongs to the one answered next",
            {Send("r1", 1), Send("r2", 1), Edit(a), Answer("r1", 1), Edit(b), Answer("r2", 1)},
            {"r1/1 (1,1) 1/3/4", "r2/1 (3,3) 2/5/6"}},
           {"guidance that answers no picture takes no edit from the open ones",
            {Send("r1", 1), Edit(a), Answer("r2", 0), Edit(b), Answer("r1", 1)},
            {"r1/1 (1,1)(3,3) 1/2/5"}},
           {"the first edit of a picture is the first since it came",
            {Edit(b), Send("r1", 1), Edit(a), Answer("r1", 1)},
            {"r1/1 (1,1) 2/3/4"}},
           {"a picture without an answer ends with the robot's next one",
            {Send("r1", 1), Edit(a), Send("r1", 2), Answer("r1", 2)},
            {"r1/1 (1,1) 1/2/-", "r1/2 - 3/-/4"}},
           {"streamed and repeated pictures, and those answered before, open nothing",
            {Stream, Answer("r1", 1), Send("r1", 2), Answer("r1", 2), Send("r1", 2), SkipFiveOfR2,
             Send("r2", 5), End},
            {"r1/2 - 3/-/4"}},
           {"at the end an open picture counts with an edit",
            {Send("r1", 1), Edit(a), End},
            {"r1/1 (1,1) 1/2/-"}},
           {"... and not without", {Send("r1", 1), End}, {}},
           {"a person who finishes has looked at the open picture, with an edit",
            {Send("r1", 1), Edit(a), Finish},
            {"r1/1 (1,1) 1/2/3"}},
           {"... or without, once", {Send("r1", 1), Finish, Finish}, {"r1/1 - 1/-/2"}},
           {"a robot that starts again counts its pictures from the beginning",
            {Robot("r1", 100), Send("r1", 7), Robot("r1", 3), Send("r1", 1), Answer("r1", 1)},
            {"r1/1 - 2/-/3"}},
       }) {
    CAPTURE(row.rule);
    Session session;
    for (const Step& step : row.steps) step(session);
    std::vector<std::string> segments;
    for (const RecordedSegment& done : session.collector.Take()) {
      CHECK(CheckSegment(done.segment).has_value());
      CHECK(done.segment.step == segments.size());  // counts a world's, from any robot
      segments.push_back(Summary(done));
    }
    CHECK(segments == row.segments);
  }
}

TEST_CASE("A segment has what the picture shows, its pixels moved, and what is known of the maze",
          "[operator][recording]") {
  Session session;
  Snapshot snapshot = session.Taken("r1", 1);
  const std::uint8_t* pixels = snapshot.jpeg.data();
  session.collector.Receive(std::move(snapshot), session.clock.Now());
  CHECK(session.collector.Take().empty());
  session.Answer("r1", 1);
  const RecordedSegment done = session.Only();
  const Segment& segment = done.segment;
  CHECK(segment.query.belief == DrawnMap(kMap));
  CHECK(segment.query.path == std::vector<Cell>{{1, 1}, {1, 2}});
  CHECK(segment.query.cell == Cell{1, 2});
  CHECK(segment.query.heading_rad == 1.5);
  CHECK(segment.query.visible == VisibleCells{{{1, 2}}, {{0, 2}}});
  CHECK(segment.goals_reached == 1);
  CHECK(done.world == "w1");
  CHECK(done.jpeg == std::vector<std::uint8_t>{1, 2, 3});
  CHECK(done.jpeg.data() == pixels);
  const Trajectory& trajectory = done.trajectory;
  CHECK(trajectory.origin == SegmentOrigin::kPerson);
  CHECK(trajectory.participant == "p07");
  CHECK(trajectory.session == "s1");
  CHECK(trajectory.world == "conav13");
  CHECK(trajectory.world_seed == 7);
  CHECK(trajectory.corruption_seed == 9);
  CHECK_FALSE(trajectory.truth);
}

TEST_CASE("Accuracies are measured where the true map is known", "[operator][recording]") {
  Session session;
  OccupancyGrid truth = ToOccupancy(DrawnMap(kMap));
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

TEST_CASE("A true map of another size is left out, even odds count as a wall",
          "[operator][recording]") {
  Session session;
  session.collector.SetTruth("w1", OccupancyGrid(3, 3, Occupancy::kFree));
  session.belief.wall_probability[{1, 1}] = 0.5F;
  session.collector.Edited(session.belief, session.clock.Now());
  session.Send("r1", 1);
  session.Answer("r1", 1);
  const RecordedSegment done = session.Only();
  CHECK_FALSE(done.trajectory.truth);
  CHECK(done.segment.query.belief[{1, 1}] == 1.0F);
}

TEST_CASE("Mazes are named with world, preset and seed", "[operator][recording]") {
  for (const auto& [text, name, seed] : std::vector<std::tuple<const char*, const char*, unsigned>>{
           {"w1=conav13@7", "conav13", 7},
           {"w1=/maps/a=b.yaml", "/maps/a=b.yaml", 0},
           {"w1=/maps/x@2@11", "/maps/x@2", 11}}) {
    CAPTURE(text);
    const auto facts = ParseMazeFacts({text});
    REQUIRE(facts);
    CHECK(facts->at("w1").name == name);
    CHECK(facts->at("w1").world_seed == seed);
    CHECK(facts->at("w1").corruption_seed == seed);
  }
  for (const char* bad : {"", "w1", "=conav13", "w1=conav13@", "w1=conav13@x", "w1=conav13@-1"}) {
    const auto refused = ParseMazeFacts({bad});
    REQUIRE_FALSE(refused);
    CHECK_THAT(refused.error().text, Catch::Contains(bad));
  }
}

}  // namespace
}  // namespace conav::operators
