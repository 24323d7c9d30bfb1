#include "operator/simulated/synthetic_teleoperator.h"

#include <catch2/catch.hpp>
#include <cmath>

#include "common/grid/visibility.h"
#include "operator/simulated/path_planner.h"
#include "unit/operator/support/synthetic_fixture.h"

namespace conav::operators {
namespace {

using namespace std::chrono_literals;

const SyntheticOperatorParameters default_person;

/// Robots that do exactly what keys are expected to do, in a world of 2 m cells, with streamed
/// pictures; and a person with a map of it. Every request is accepted at once.
class Maze {
 public:
  struct Robot {
    RobotState state;
    std::vector<DriveAction> keys;
  };

  Maze(const std::vector<std::string>& truth, const std::vector<std::string>& map,
       const std::map<std::string, std::pair<Cell, Cell>>& starts_and_goals,
       const SyntheticOperatorParameters& parameters = default_person, std::uint64_t seed = 1)
      : truth_(DrawnMap(truth)), person(parameters, seed, WorldsOf(starts_and_goals)) {
    belief_.world = "w1";
    belief_.wall_probability = DrawnMap(map);
    for (const auto& [name, way] : starts_and_goals) {
      robots[name].state = {.world = "w1",
                            .robot = name,
                            .cell = way.first,
                            .position = Geometry().CellToPosition(way.first),
                            .goals_left = {way.second}};
    }
    person.Receive(belief_);
    person.ReceiveCellSize("w1", 2.0);
    for (const auto& [name, robot] : robots) person.Receive(robot.state);
  }

  /// Until the person has nothing to ask, at most `asks` requests. True when all goals are reached.
  bool Run(int asks = 3000) {
    for (int i = 0; i < asks; ++i) {
      const auto ask = person.Next(clock.Now());
      if (!ask) break;
      OperatorReply reply{"c", 1, true, "", 0};
      if (const auto* edit = std::get_if<EditRequest>(&ask->body)) {
        reply.revision = Edit(*edit);
      } else {
        reply.revision = Press(std::get<DriveRequest>(ask->body));
      }
      person.Answered(reply, clock.Now());
    }
    return std::all_of(robots.begin(), robots.end(),
                       [](const auto& entry) { return entry.second.state.goals_left.empty(); });
  }

  std::map<std::string, Robot> robots;
  FakeClock clock;

 private:
  static std::map<std::string, std::string> WorldsOf(
      const std::map<std::string, std::pair<Cell, Cell>>& robots) {
    std::map<std::string, std::string> worlds;
    for (const auto& [name, way] : robots) worlds[name] = "w1";
    return worlds;
  }

  GridGeometry Geometry() const { return {truth_.rows(), truth_.columns(), 2.0}; }

  std::uint64_t Edit(const EditRequest& edit) {
    CHECK(edit.base_revision == belief_.revision);
    for (const CellEdit& value : edit.edits) {
      belief_.wall_probability[value.cell] = value.wall ? 1.0F : 0.0F;
    }
    ++belief_.revision;
    person.Receive(belief_);
    return belief_.revision;
  }

  std::uint64_t Press(const DriveRequest& request) {
    Robot& robot = robots.at(request.robot);
    RobotState& state = robot.state;
    robot.keys.push_back(request.drive);
    const ShownPose next =
        Expect(SteeringParameters{}, {state.position, state.heading_rad}, request.drive);
    now_ = now_ + 250ms;
    state.stamp = now_;
    state.command_outcome = CommandOutcome::kDone;
    // The body is a square of 0.4 m here.
    for (const auto& [dx, dy] : {std::pair{0.2, 0.2}, {0.2, -0.2}, {-0.2, 0.2}, {-0.2, -0.2}}) {
      const Cell cell = Geometry().PositionToCell({next.position.x_m + dx, next.position.y_m + dy});
      if (IsWall(truth_, cell)) Stop(state, CommandOutcome::kBlocked, cell);
      for (const auto& [name, other] : robots) {
        if (name == request.robot) continue;
        const double away = std::hypot(other.state.position.x_m - next.position.x_m,
                                       other.state.position.y_m - next.position.y_m);
        if (cell == other.state.cell || away < 0.6) Stop(state, CommandOutcome::kOccupied, cell);
      }
    }
    if (state.command_outcome == CommandOutcome::kDone) {
      state.position = next.position;
      state.heading_rad = next.heading_rad;
      state.cell = Geometry().PositionToCell(next.position);
      std::erase(state.goals_left, state.cell);
    }
    Show(state);
    return state.drive_order;
  }
  static void Stop(RobotState& state, CommandOutcome outcome, Cell cell) {
    state.command_outcome = outcome;
    state.command_cell = cell;
  }
  void Show(RobotState& state) {
    ++state.drive_order;
    ++state.snapshots;
    const CameraView view = ViewAt(state.cell, state.heading_rad, 2.0, 320, 192);
    person.Receive(Snapshot{.world = "w1",
                            .robot = state.robot,
                            .sequence_number = state.snapshots,
                            .streamed = true,
                            .cell = state.cell,
                            .heading_rad = state.heading_rad,
                            .visible = CastView(ToOccupancy(truth_), view),
                            .path = {state.cell}});
    person.Receive(state);
  }

  BeliefGrid truth_;
  Belief belief_;
  SimTime now_;

 public:
  SyntheticTeleoperator person;
};

const std::vector<std::string> kMazeTruth{"#########", "#       #", "# ##### #", "#     # #",
                                          "### # # #", "#   #   #", "#########"};
/// The way by the south is open on the map but closed in truth, and the other way round.
const std::vector<std::string> kWrongMap{"#########", "#   #   #", "# ##### #", "#       #",
                                         "### # ###", "#   #   #", "#########"};

/// A person who is shown a map and robot r1 at its start, and answered by hand.
struct Seat {
  explicit Seat(const SyntheticOperatorParameters& parameters = default_person,
                std::uint64_t seed = 1)
      : person(parameters, seed, {{"r1", "w1"}}) {
    CHECK_FALSE(Next());
    person.Receive(Belief{{0}, "w1", 0, DrawnMap(kWrongMap), ""});
    person.ReceiveCellSize("w1", 2.0);
    state.position = {-6.0, 4.0};
    person.Receive(state);
  }
  std::optional<OperatorAsk> Next() { return person.Next(clock.Now()); }
  DriveAction ExpectKey() {
    const auto ask = Next();
    REQUIRE(ask);
    return std::get<DriveRequest>(ask->body).drive;
  }
  void Accept() { person.Answered(OperatorReply{"c", 1, true, "", 1}, clock.Now()); }
  void Refuse() { person.Answered(OperatorReply{"c", 1, false, "no", 0}, clock.Now()); }

  FakeClock clock;
  SyntheticTeleoperator person;
  RobotState state{.world = "w1", .robot = "r1", .cell = {1, 1}, .goals_left = {{5, 7}}};
};

}  // namespace

TEST_CASE("a teleoperator with a wrong map reaches the goal by what the pictures show",
          "[simulated]") {
  const std::uint64_t seed = GENERATE(1, 2, 3, 4, 5);
  Maze maze(kMazeTruth, kWrongMap, {{"r1", {{1, 1}, {5, 7}}}}, default_person, seed);
  CHECK(maze.Run());
  CHECK(maze.person.counts().edits > 0);
  CHECK(maze.person.open() == 0);
}

TEST_CASE("clumsy hands arrive too, with more keys, equal seeds press the same keys",
          "[simulated]") {
  SyntheticOperatorParameters clumsy;
  clumsy.steering.slip_probability = 0.2;
  clumsy.steering.overshoot_probability = 0.3;
  const auto keys = [](const std::vector<std::string>& map, Cell goal,
                       const SyntheticOperatorParameters& person, std::uint64_t seed) {
    Maze maze(kMazeTruth, map, {{"r1", {{1, 1}, goal}}}, person, seed);
    REQUIRE(maze.Run());
    return maze.robots["r1"].keys;
  };
  CHECK(keys(kMazeTruth, {5, 1}, clumsy, 1).size() >
        keys(kMazeTruth, {5, 1}, default_person, 1).size());
  const auto first = keys(kWrongMap, {5, 7}, default_person, 1);
  CHECK(first == keys(kWrongMap, {5, 7}, default_person, 1));
  CHECK(first != keys(kWrongMap, {5, 7}, default_person, 2));
}

TEST_CASE("one robot is steered after the other, and the one in the way makes room",
          "[simulated]") {
  const std::vector<std::string> corridor{"#########", "#       #", "#### ####", "#########"};
  Maze maze(corridor, corridor, {{"r1", {{1, 1}, {1, 7}}}, {"r2", {{1, 7}, {1, 1}}}});
  CHECK(maze.Run());
  CHECK(maze.person.counts().meetings > 0);
  // A robot without goals that stands on another one's goal is driven off it.
  const std::vector<std::string> room{"#####", "#   #", "#   #", "#####"};
  Maze parked(room, room, {{"r1", {{1, 3}, {1, 3}}}, {"r2", {{2, 1}, {1, 3}}}});
  parked.robots["r1"].state.goals_left.clear();
  parked.person.Receive(parked.robots["r1"].state);
  CHECK(parked.Run());
  CHECK_FALSE(parked.robots["r1"].keys.empty());
}

TEST_CASE("a key is pressed when the last one was carried out and shown, not before",
          "[simulated]") {
  Seat seat;
  seat.ExpectKey();
  CHECK_FALSE(seat.Next());  // one request at a time
  seat.Accept();
  CHECK_FALSE(seat.Next());  // not carried out
  seat.state.drive_order = 1;
  seat.state.command_outcome = CommandOutcome::kRunning;
  seat.person.Receive(seat.state);
  CHECK_FALSE(seat.Next());
  seat.state.command_outcome = CommandOutcome::kDone;
  seat.state.snapshots = 1;
  seat.person.Receive(seat.state);
  CHECK_FALSE(seat.Next());  // its picture is not here
  seat.person.Receive(SnapshotOf(1, 0));
  const auto key = seat.Next();
  REQUIRE(key);
  CHECK(std::get<DriveRequest>(key->body).expires_at > seat.state.stamp);
}

TEST_CASE("an order that nobody carries out is repeated after a pause", "[simulated]") {
  Seat seat;
  seat.ExpectKey();
  seat.Accept();
  CHECK_FALSE(seat.Next());
  seat.clock.Advance(3s);
  seat.ExpectKey();
}

TEST_CASE("a key that is refused is pressed again, whatever chance would say now", "[simulated]") {
  SyntheticOperatorParameters clumsy;
  clumsy.steering.slip_probability = 0.5;  // one key in two
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Seat seat(clumsy, seed);
    const DriveAction first = seat.ExpectKey();
    seat.Refuse();
    CHECK_FALSE(seat.Next());
    seat.clock.Advance(1s);
    CHECK(seat.ExpectKey() == first);
    CHECK(seat.person.counts().newest_problem == "no");
    seat.Refuse();
    // Elsewhere by now: a key of its own, for the new state.
    seat.state.stamp = seat.state.stamp + 1s;
    seat.person.Receive(seat.state);
    seat.clock.Advance(1s);
    CHECK(seat.Next()->stamp == seat.state.stamp);
  }
}

}  // namespace conav::operators
