#include "planner/decision/traffic.h"

#include <catch2/catch.hpp>
#include <set>

#include "planner/decision/robot_worker.h"
#include "unit/planner/search/text_map.h"

using namespace conav;
using namespace conav::planner;
using namespace std::chrono_literals;

namespace {

Situation RobotAt(const std::string& robot, Cell cell, const std::vector<std::string_view>& lines) {
  Situation situation;
  situation.state.robot = robot;
  situation.state.cell = cell;
  situation.map.cells = MapFrom(lines);
  return situation;
}

/// The first cell by which the robot makes room.
std::optional<Cell> StepAside(const Situation& situation, const std::vector<Cell>& own_path) {
  const RoomClaim room = MakeRoom(situation, own_path);
  return room.cells.empty() ? std::nullopt : std::optional(room.cells.front());
}

/// A corridor with one bay.
const std::vector<std::string_view> kBay{"#######", "#     #", "### ###", "#######"};

/// The longest of many waits after the robot made room `times` times, and how many differ.
std::pair<std::chrono::nanoseconds, std::size_t> Waits(int times) {
  constexpr std::chrono::milliseconds kSlot{100};
  std::set<std::chrono::nanoseconds> waits;
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    YieldBackoff backoff(seed);
    for (int i = 0; i < times; ++i) backoff.MakesRoom(Clock::TimePoint(1s), kSlot);
    waits.insert(backoff.until() - Clock::TimePoint(1s));
  }
  return {*waits.rbegin(), waits.size()};
}

}  // namespace

TEST_CASE("the desired way is the shortest one over what may be free", "[planner][traffic]") {
  Situation situation = RobotAt("r1", {1, 1}, {"#####", "# ? #", "# # #", "#   #", "#####"});
  situation.state.goals_left = {{1, 3}};
  CHECK(DesiredPath(situation) == std::vector<Cell>{{1, 2}, {1, 3}});
  situation.map.cells[{1, 2}] = Occupancy::kOccupied;
  CHECK(DesiredPath(situation).size() == 6);
}

TEST_CASE("the robot that goes before stays on its way and waits", "[planner][traffic]") {
  Situation situation = RobotAt("r1", {1, 2}, kBay);
  situation.state.goals_left = {{1, 5}};
  situation.neighbours = {{"r2", {1, 3}, true, {{1, 2}, {1, 1}}}};
  CHECK_FALSE(StepAside(situation, DesiredPath(situation)).has_value());
  REQUIRE(WaitsFor(situation, DesiredPath(situation)) != nullptr);
  CHECK(WaitsFor(situation, DesiredPath(situation))->robot == "r2");
}

// A command into such a cell ends as occupied at once; robots gave it again and again.
TEST_CASE("a cell that another robot drives into is taken until it has ended",
          "[planner][traffic]") {
  Situation situation = RobotAt("r1", {1, 2}, kBay);
  situation.neighbours = {
      {"r2", {1, 4}, true, {{1, 3}, {1, 2}}, {}, true, std::optional(Cell{1, 3})}};
  CHECK(IsTaken(situation, {1, 3}));
  CHECK(IsTaken(situation, {1, 4}));
  CHECK_FALSE(IsTaken(situation, {1, 5}));
  CHECK(TakenCells(situation) == std::vector<Cell>{{1, 4}, {1, 3}});
  situation.state.goals_left = {{1, 5}};
  const Neighbour* other = InTheWay(situation, DesiredPath(situation));
  REQUIRE(other != nullptr);

  FakeClock clock;
  Patience patience(clock);
  CHECK(patience.Holds(other));
  CHECK(patience.Wait().again == Clock::TimePoint::max());  // its end is a change
  clock.Advance(10s);
  Neighbour stands = *other;
  stands.is_driving = false;
  CHECK(patience.Holds(&stands));
  CHECK(patience.Wait().again == clock.Now() + kPatience);
  clock.Advance(kPatience);
  CHECK_FALSE(patience.Holds(&stands));
}

TEST_CASE("a robot on the path of one with the right of way steps into the bay",
          "[planner][traffic]") {
  struct Row {
    const char* name;
    Cell cell;
    std::vector<Cell> goals, own_path;
    Neighbour other;
    std::optional<Cell> step;
  };
  const Neighbour first{"r1", {1, 2}, true, {{1, 3}, {1, 4}, {1, 5}}};
  const Neighbour last{"r9", {1, 4}, true, {{1, 3}, {1, 2}}};
  for (const Row& row : std::vector<Row>{
           {"of one before it by name", {1, 3}, {{1, 1}}, {}, first, Cell{2, 3}},
           {"without goals, of any other", {1, 3}, {}, {}, last, Cell{2, 3}},
           {"while it waits for its operator", {1, 3}, {{1, 5}}, {}, last, Cell{2, 3}},
           {"but not where it goes before", {1, 3}, {{1, 5}}, {{1, 4}, {1, 5}}, last, std::nullopt},
           {"and not off the path", {2, 3}, {}, {}, first, std::nullopt}}) {
    Situation situation = RobotAt("r2", row.cell, kBay);
    situation.state.goals_left = row.goals;
    situation.neighbours = {row.other};
    CAPTURE(row.name);
    CHECK(StepAside(situation, row.own_path) == row.step);
  }
}

TEST_CASE("the robot that goes before does not shut in the one that has to make room",
          "[planner][traffic]") {
  Situation situation = RobotAt("r1", {1, 2}, kBay);
  situation.state.goals_left = {{1, 5}};
  situation.neighbours = {{"r2", {1, 4}, true, {{1, 3}, {1, 2}}}};
  // Beyond the bay; from (1,3) on, r2 could not reach it.
  REQUIRE(WaitsFor(situation, DesiredPath(situation)) != nullptr);
  situation.neighbours[0].cell = {2, 3};
  CHECK(WaitsFor(situation, DesiredPath(situation)) == nullptr);
}

TEST_CASE("a robot that is shut in goes before the one that it has to let pass",
          "[planner][traffic]") {
  Situation shut_in = RobotAt("r2", {1, 5}, kBay);
  shut_in.neighbours = {{"r1", {1, 4}, true, {{1, 5}}}};
  const RoomClaim claim = MakeRoom(shut_in, {});
  CHECK(claim.right == RightOfWay{RightOfWay::kShutIn, "r2", 0});
  CHECK(claim.cells == std::vector<Cell>{{1, 4}, {1, 3}});
  Situation before = RobotAt("r1", {1, 4}, kBay);
  before.state.goals_left = {{1, 5}};
  before.neighbours = {{"r2", {1, 5}, false, {}, claim}};
  SECTION("which backs off") {
    const RoomClaim room = MakeRoom(before, DesiredPath(before));
    CHECK(room.right == RightOfWay{RightOfWay::kShutIn, "r2", 1});
    REQUIRE(room.cells.size() == 2);
    CHECK(room.cells.front() == Cell{1, 3});
  }
  SECTION("and does not come back onto its way") {
    before.state.cell = {2, 3};
    CHECK(IsTaken(before, {1, 3}));
    CHECK_FALSE(StandsOn(before, {1, 3}));
  }
}

TEST_CASE("a robot that makes room asks the one behind it with the right that it was asked with",
          "[planner][traffic]") {
  const std::vector<std::string_view> lines{"########", "#      #", "####  ##", "########"};
  Situation middle = RobotAt("r3", {1, 3}, lines);
  middle.neighbours = {{"r1", {1, 1}, true, {{1, 2}, {1, 3}, {1, 4}, {1, 5}, {1, 6}}},
                       {"r2", {1, 4}, true, {}}};
  const RoomClaim room = MakeRoom(middle, {{1, 2}});
  CHECK(room.cells == std::vector<Cell>{{1, 4}, {2, 4}});
  CHECK(room.right == RightOfWay{RightOfWay::kHasPath, "r1", 1});
  Situation behind = RobotAt("r2", {1, 4}, lines);
  behind.neighbours = {{"r3", {1, 3}, true, {{1, 2}}, room}};
  const RoomClaim next = MakeRoom(behind, {});
  CHECK(next.cells == std::vector<Cell>{{1, 5}});
  CHECK(next.right.passed_on == 2);
}

TEST_CASE("shut in without a known way out: waits, then insists on its own way",
          "[planner][traffic]") {
  // Nothing is known beyond the robot that stands before it.
  Situation shut_in = RobotAt("r2", {1, 3}, {"######", "??  ##", "######"});
  shut_in.neighbours = {{"r1", {1, 2}, true, {{1, 3}}}};
  const std::vector<Cell> own_path{{1, 2}, {1, 1}};
  CHECK(MakeRoom(shut_in, own_path).cells.empty());
  const RoomClaim claim = MakeRoom(shut_in, own_path, true);
  CHECK(claim.right == RightOfWay{RightOfWay::kShutIn, "r2", 0});
  CHECK(claim.cells == own_path);
}

TEST_CASE(
    "for one that is shut in a robot backs off along its path, or onto that of one that waits",
    "[planner][traffic]") {
  const bool has_bay = GENERATE(false, true);
  Situation situation =
      RobotAt("r1", {1, 3}, {"#######", "#    ##", has_bay ? "### ###" : "#######", "#######"});
  Neighbour shut_in{"r2", {1, 4}, true, {}, {}};
  shut_in.room = {{{1, 3}, {1, 2}, {1, 1}}, {RightOfWay::kShutIn, "r2", 0}};
  // Wants through the bay's cell.
  situation.neighbours = {shut_in, {"r0", {1, 5}, true, {{1, 4}, {1, 3}, {2, 3}}}};
  CHECK(StepAside(situation, {}) == (has_bay ? Cell{2, 3} : Cell{1, 2}));
}

TEST_CASE("a robot that need not yield to the first one yet makes room for the next",
          "[planner][traffic]") {
  Situation situation = RobotAt("r3", {1, 6}, {"#########", "#       #", "###### ##", "#########"});
  situation.neighbours = {{"r1", {1, 1}, true, {{1, 2}, {1, 3}, {1, 4}, {1, 5}, {1, 6}, {1, 7}}},
                          {"r2", {1, 7}, true, {{1, 6}, {1, 5}}}};
  CHECK(StepAside(situation, {}) == Cell{2, 6});
}

TEST_CASE("a robot that makes room goes on at once, then waits longer, each for another time",
          "[planner][traffic]") {
  for (const auto& [times, longest] : std::vector<std::pair<int, std::chrono::milliseconds>>{
           {1, 0ms}, {2, 200ms}, {3, 600ms}, {4, 1400ms}, {50, 1400ms}}) {
    CAPTURE(times);
    CHECK(Waits(times).first == longest);
  }
  CHECK(Waits(4).second > 10);
  YieldBackoff backoff(1);
  for (int i = 0; i < 4; ++i) backoff.MakesRoom(Clock::TimePoint(1s), 100ms);
  for (int i = 0; i < YieldBackoff::kOwnMoves; ++i) backoff.Moves();
  backoff.MakesRoom(Clock::TimePoint(11s), 100ms);  // it moved on: the shortest wait again
  CHECK(backoff.until() == Clock::TimePoint(11s));
}
