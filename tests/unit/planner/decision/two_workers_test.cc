#include <catch2/catch.hpp>
#include <map>

#include "planner/decision/goal_pose.h"
#include "planner/decision/make_method.h"
#include "planner/decision/robot_worker.h"
#include "planner/search/fake_perception_model.h"
#include "unit/planner/search/text_map.h"

using namespace conav;
using namespace conav::planner;
using namespace std::chrono_literals;

namespace {

/// A corridor with one bay, known to all: two robots that want to the other's end.
const std::vector<std::string_view> kCorridor{"#######", "#     #", "### ###", "#######"};

/// Two workers, with robots that do at once what they are told and an operator who answers at once
/// with the shortest way, blind to other robots.
class Corridor {
 public:
  explicit Corridor(const std::string& method) {
    Add("r1", {1, 1}, {1, 5}, method);
    Add("r2", {1, 5}, {1, 1}, method);
  }

  bool RunsToTheEnd(int rounds) {
    for (int round = 0; round < rounds; ++round) {
      for (auto& [name, robot] : robots_) robot.worker->Step(stop_);
      clock_.Advance(100ms);
      if (robots_["r1"].state.goals_left.empty() && robots_["r2"].state.goals_left.empty()) {
        return true;
      }
    }
    return false;
  }

 private:
  struct Robot {
    RobotState state;
    Cell goal;
    std::uint64_t guidance = 0;  // revision
    std::optional<RobotWorker> worker;
  };

  static MapUpdate Map() { return {{}, 2.0, MapFrom(kCorridor)}; }

  static Belief TheBelief() {
    Belief belief;
    belief.world = "w1";
    belief.wall_probability = BeliefFrom(kCorridor);
    return belief;
  }

  void Add(const std::string& name, Cell start, Cell goal, const std::string& method) {
    Robot& robot = robots_[name];
    robot.goal = goal;
    robot.state.world = "w1";
    robot.state.robot = name;
    robot.state.cell = start;
    robot.state.path = {start};
    robot.state.goals_left = {goal};
    SearchConfig search;
    search.options.iterations = 200;
    RobotWorker::Outputs outputs{
        .command = [this, &robot](const RobotCommand& command) { Do(robot, command); },
        .report = [](const SearchReport&) {},
        .attention = [this, &robot](const AttentionRequest&) { Guide(robot); },
        .way = [](const RobotState&, const MapUpdate&, const std::vector<Cell>&) {}};
    auto made = MakeMethod(method, name, search, robots_.size(),
                           std::make_shared<FakePerceptionModel>(), nullptr, clock_);
    const DecisionGate::Options gate{10s, 10s, made->pictures_are_answered()};
    robot.worker.emplace(
        RobotWorker::Options{
            .robot = name, .method_name = method, .gate = gate, .command_ttl = 10s},
        std::move(made), board_, clock_, std::move(outputs));
    board_.Put(robot.state);
    board_.PutMap(name, Map());
    board_.PutLens(name, CameraLens{});
    board_.Put(TheBelief());
    Guide(robot);
  }

  void Do(Robot& robot, const RobotCommand& command) {
    RobotState& state = robot.state;
    state.stamp = state.stamp + 250ms;
    state.lease_epoch = command.lease_epoch;
    state.command_sequence_number = command.sequence_number;
    state.command_outcome = CommandOutcome::kDone;
    if (command.kind == CommandKind::kTransmitView) {
      ++state.snapshots;
      state.path = {state.cell};
      Guide(robot);
    } else {
      const bool taken = std::any_of(robots_.begin(), robots_.end(), [&](const auto& other) {
        return other.second.state.cell == command.target;
      });
      if (taken) {
        state.command_outcome = CommandOutcome::kOccupied;
      } else {
        state.cell = command.target;
        state.path.push_back(state.cell);
        std::erase(state.goals_left, state.cell);
      }
    }
    board_.Put(state);
  }

  void Guide(Robot& robot) {
    const MapUpdate map = Map();
    const GridGeometry geometry{map.cells.rows(), map.cells.columns(), map.cell_size_m};
    auto guidance = GuidanceTowards(geometry.CellToPosition(robot.goal), robot.state, map,
                                    TheBelief(), std::nullopt);
    REQUIRE(guidance);
    guidance->revision = ++robot.guidance;
    guidance->answers_snapshot = robot.state.snapshots;
    board_.Put(*std::move(guidance));
  }

  Blackboard board_{{{"r1", "w1"}, {"r2", "w1"}}};
  FakeClock clock_;
  StopToken stop_;
  std::map<std::string, Robot> robots_;
};

}  // namespace

TEST_CASE("two robots that meet in a corridor both arrive, whatever the method by which they drive",
          "[planner][worker][traffic]") {
  const std::string method = GENERATE("ig-mcts", "instruction");
  INFO(method);
  CHECK(Corridor(method).RunsToTheEnd(300));
}
