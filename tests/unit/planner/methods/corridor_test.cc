#include <fmt/core.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "common/grid/visibility.h"
#include "common/msg/perception_model.h"
#include "planner/decision/robot_worker.h"
#include "planner/methods/make_method.h"
#include "unit/planner/search/text_map.h"

namespace conav::planner {
namespace {

/// What the robots of a crowd know, and what else differs between two runs.
struct CrowdOptions {
  std::string method = "ig-mcts";
  bool map_is_known = true;  // false: they see two cells far
  /// The order in which the robots turn is drawn with it; 0 = by name.
  std::uint64_t seed = 0;
  int command_rounds = 0;  // that a command takes; 0: it is done at once
};

/// Workers of several robots on a small map, with an
/// operator who answers at once with the shortest way, blind to other robots.
///
/// The map: '#' is a wall; '1' to '4' are the starts of r1 to r4, 'a' to 'd' their goals; the rest
/// is free. A robot without a letter has no goal and stands where it is. The robot
/// `silent` gets no answer from its operator.
class Crowd {
 public:
  Crowd(std::vector<std::string> rows, CrowdOptions options, const std::string& silent = "")
      : options_(std::move(options)), silent_(silent), random_(options_.seed) {
    const std::vector<std::string_view> lines(rows.begin(), rows.end());
    truth_ = MapFrom(lines);
    belief_ = BeliefFrom(lines);
    for (char digit = '1'; digit <= '4'; ++digit) {
      const auto start = CellsMarked(lines, digit);
      const auto goal = static_cast<char>('a' + (digit - '1'));
      if (!start.empty()) Add(fmt::format("r{}", digit), start[0], CellsMarked(lines, goal));
    }
    for (auto& [name, robot] : robots_) {
      Look(robot);
      board_.Put(TheBelief());
      Guide(robot);
    }
  }

  /// True when all have reached their goals within `rounds` turns of everybody.
  bool RunsToTheEnd(int rounds) {
    for (int round = 0; round < rounds; ++round) {
      std::vector<Robot*> order;
      for (auto& [name, robot] : robots_) order.push_back(&robot);
      if (options_.seed != 0) random_.Shuffle(order);
      for (Robot* robot : order) {
        if (robot->running && --robot->rounds_left <= 0) Finish(*robot);
        robot->worker->Step(stop_);
        REQUIRE(EachInACellOfItsOwn());
      }
      clock_.Advance(std::chrono::milliseconds(100));
      if (AllArrived()) return true;
    }
    return false;
  }

  RobotState& state(const std::string& robot) { return robots_.at(robot).state; }
  /// Where everybody is, for the message of a failed check.
  std::string Snapshot() const {
    std::string text;
    for (const auto& [name, robot] : robots_) {
      text += fmt::format("{} at {}, {} goals left, waits for {}\n", name, robot.state.cell,
                          robot.state.goals_left.size(), board_.BlockedReasonOf(name));
    }
    return text;
  }

 private:
  struct Robot {
    RobotState state;
    MapUpdate map;
    std::uint64_t guidance = 0;  // revision
    std::optional<RobotCommand> running;
    int rounds_left = 0;
    std::optional<RobotWorker> worker;
  };

  Belief TheBelief() const { return {.world = "w1", .wall_probability = belief_}; }

  void Add(const std::string& name, Cell start, std::vector<Cell> goals) {
    Robot& robot = robots_[name];
    robot.state.world = "w1";
    robot.state.robot = name;
    robot.state.grid = {truth_.rows(), truth_.columns(), 2.0};
    robot.state.cell = start;
    robot.state.path = {start};
    robot.state.goals_left = std::move(goals);
    robot.map = {{},
                 2.0,
                 options_.map_is_known
                     ? truth_
                     : OccupancyGrid(truth_.rows(), truth_.columns(), Occupancy::kUnknown)};
    SearchConfig search;
    search.options.iterations = 200;
    RobotWorker::Outputs outputs{
        .command = [this, &robot](const RobotCommand& command) { Do(robot, command); },
        .report = [](const SearchReport&) {},
        .attention = [this, &robot](const AttentionRequest&) { Guide(robot); },
        .plan = [](const RobotState&, const MapUpdate&, const std::vector<Cell>&) {}};
    const std::uint64_t seed = DeriveSeed(options_.seed, robots_.size());
    auto method = MakeMethod(ParseMethod(options_.method).value(), {search, {}}, seed,
                             std::make_shared<FakePerceptionModel>(), nullptr, clock_);
    constexpr std::chrono::seconds kTimeout{10};
    robot.worker.emplace(RobotWorker::Options{.robot = name,
                                              .method_name = options_.method,
                                              .timeouts = {kTimeout, kTimeout},
                                              .command_ttl = kTimeout,
                                              .seed = seed},
                         std::move(method), board_, clock_, std::move(outputs));
    board_.Put(robot.state);
    board_.PutLens(name, CameraLens{});
  }

  void Look(Robot& robot) {
    const VisibleCells seen = CastRange(truth_, robot.state.cell, 2.0);
    for (const Cell cell : seen.free) robot.map.cells[cell] = Occupancy::kFree;
    for (const Cell cell : seen.walls) robot.map.cells[cell] = Occupancy::kOccupied;
    board_.PutMap(robot.state.robot, robot.map);
  }

  void Do(Robot& robot, const RobotCommand& command) {
    RobotState& state = robot.state;
    state.stamp = state.stamp + std::chrono::milliseconds(250);
    state.lease_epoch = command.lease_epoch;
    state.command_sequence_number = command.sequence_number;
    state.command_outcome = CommandOutcome::kRunning;
    state.command_cell =
        command.path.empty() ? state.cell : state.grid.PositionToCell(command.path.at(0));
    board_.Put(state);
    robot.running = command;
    robot.rounds_left = options_.command_rounds;
    if (robot.rounds_left == 0) Finish(robot);
  }

  void Finish(Robot& robot) {
    const RobotCommand command = *std::exchange(robot.running, std::nullopt);
    RobotState& state = robot.state;
    state.stamp = state.stamp + std::chrono::milliseconds(250);
    state.command_outcome = CommandOutcome::kDone;
    if (command.kind == CommandKind::kTransmitView) {
      ++state.snapshots;
      state.path = {state.cell};
      Guide(robot);
    } else if (const Cell target = state.grid.PositionToCell(command.path.at(0));
               truth_[target] == Occupancy::kOccupied) {
      state.command_outcome = CommandOutcome::kBlocked;
      robot.map.cells[target] = Occupancy::kOccupied;
    } else if (IsTaken(target)) {
      state.command_outcome = CommandOutcome::kOccupied;
    } else {
      state.cell = target;
      state.path.push_back(state.cell);
      std::erase(state.goals_left, state.cell);
    }
    Look(robot);
    board_.Put(state);
  }

  bool IsTaken(Cell cell) const {
    return std::any_of(robots_.begin(), robots_.end(),
                       [&](const auto& other) { return other.second.state.cell == cell; });
  }

  bool EachInACellOfItsOwn() const {
    std::set<Cell> cells;
    for (const auto& [name, robot] : robots_) cells.insert(robot.state.cell);
    return cells.size() == robots_.size();
  }

  bool AllArrived() const {
    return std::all_of(robots_.begin(), robots_.end(),
                       [](const auto& robot) { return robot.second.state.goals_left.empty(); });
  }

  void Guide(Robot& robot) {
    if (robot.state.robot == silent_ || robot.state.goals_left.empty()) return;
    const GridGeometry geometry{truth_.rows(), truth_.columns(), robot.map.cell_size_m};
    const MapUpdate known{{}, robot.map.cell_size_m, truth_};
    auto guidance = GuidanceAlong({geometry.CellToPosition(robot.state.goals_left.front())},
                                  robot.state, known, TheBelief(), std::nullopt);
    REQUIRE(guidance);
    guidance->revision = ++robot.guidance;
    guidance->answers_snapshot = robot.state.snapshots;
    board_.Put(*std::move(guidance));
  }

  CrowdOptions options_;
  std::string silent_;
  Random random_;
  OccupancyGrid truth_;
  BeliefGrid belief_;
  Blackboard board_{{{"r1", "w1"}, {"r2", "w1"}, {"r3", "w1"}, {"r4", "w1"}}};
  FakeClock clock_;
  StopToken stop_;
  std::map<std::string, Robot> robots_;
};

// Robots that meet where only one fits.

constexpr int kRounds = 1000;

CrowdOptions DrawnOptions() {
  CrowdOptions options;
  options.method = GENERATE("ig-mcts", "instruction", "greedy");
  options.map_is_known = GENERATE(true, false);
  options.seed = GENERATE(range(0, 10));
  return options;
}

struct Meeting {
  const char* name;
  std::vector<std::string> rows;
};

const std::vector<Meeting> kMeetings{
    {"two head-on in a corridor with a side pocket",
     {"#########",  //
      "#1b   a2#",  //
      "#### ####",  //
      "#########"}},
    {"two head-on in a corridor without pockets between two rooms",
     {"###########",  //
      "#1 #####a #",  //
      "# b     2 #",  //
      "###########"}},
    {"the one that goes before wants into the dead end out of which the other wants",
     {"##########",  //
      "#1b#######",  //
      "#      a2#",  //
      "##########"}},
    {"a goal in a dead end behind a robot that has none",
     {"##########",  //
      "#  #######",  //
      "#1     2a#",  //
      "##########"}},
    {"a goal in a dead end behind a robot that goes before but has no goals",
     {"##########",  //
      "#  #######",  //
      "#2     1b#",  //
      "##########"}},
    {"three in a corridor with a side pocket at each end",
     {"###########",  //
      "#1 3b   a2#",  //
      "## ### #c##",  //
      "###########"}},
    {"three in a corridor without pockets, with rooms at the ends",
     {"############",  //
      "#1 c####a3 #",  //
      "#2       b #",  //
      "############"}},
    {"four exchange their places around a ring with one pocket",
     {"#########",  //
      "#1d   c2#",  //
      "# ##### #",  //
      "#3b   a4#",  //
      "#### ####",  //
      "#########"}},
    {"two come from one side and one from the other, with one pocket",
     {"############",  //
      "#c #########",  //
      "#12     ab3#",  //
      "#### #######",  //
      "############"}}};

void AllArrive(const Meeting& meeting, const CrowdOptions& options) {
  CAPTURE(meeting.name, options.method, options.map_is_known, options.seed);
  Crowd crowd(meeting.rows, options);
  const bool arrived = crowd.RunsToTheEnd(kRounds * (1 + options.command_rounds));
  INFO(crowd.Snapshot());
  CHECK(arrived);
}

TEST_CASE("robots that meet where only one fits all arrive", "[planner][traffic]") {
  const Meeting& meeting = GENERATE(from_range(kMeetings));
  AllArrive(meeting, DrawnOptions());
}

// Three robots that took 4 s a cell kept making room for each other.
TEST_CASE("slow robots that meet where only one fits all arrive", "[planner][traffic]") {
  const Meeting& meeting = GENERATE(from_range(kMeetings));
  CrowdOptions options;
  options.method = GENERATE("ig-mcts", "instruction", "greedy");
  options.seed = GENERATE(range(0, 5));
  options.command_rounds = 40;
  AllArrive(meeting, options);
}

TEST_CASE("a robot in a corridor whose operator is silent makes room, with either robot first",
          "[planner][traffic]") {
  const bool silent_first = GENERATE(false, true);
  std::vector<std::string> rows{"##########",  //
                                "#1  2   a#",  //
                                "##### ####",  //
                                "#####b####",  //
                                "##########"};
  if (silent_first) {
    rows[1] = "#2  1   b#";
    rows[3] = "#####a####";
  }
  const std::string other = silent_first ? "r2" : "r1";
  CrowdOptions options;
  options.method = "instruction";
  Crowd crowd(rows, options, silent_first ? "r1" : "r2");
  for (int round = 0; round < kRounds && !crowd.state(other).goals_left.empty(); ++round) {
    crowd.RunsToTheEnd(1);
  }
  INFO(crowd.Snapshot());
  CHECK(crowd.state(other).goals_left.empty());
}

}  // namespace
}  // namespace conav::planner
