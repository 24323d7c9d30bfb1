#include "planner/planner_service.h"

#include <catch2/catch.hpp>
#include <memory>
#include <optional>
#include <thread>

#include "common/bus/in_memory_bus.h"
#include "common/bus/publisher.h"
#include "common/msg/convert.h"

using namespace conav;
using namespace std::chrono_literals;

namespace {

/// The planner on one side of an in-memory bus; on the other the test plays simulator and operator.
class PlannerOnBus {
 public:
  explicit PlannerOnBus(const std::string& method)
      : planner_(planner_participant_, ConfigOf(method), clock_),
        thread_([this] { planner_.Run(stop_); }) {}
  ~PlannerOnBus() {
    stop_.RequestStop();
    planner_participant_.Wake();
    thread_.join();
  }

  void PublishAll() {
    MapUpdate map{{}, 2.0, OccupancyGrid(3, 6, Occupancy::kOccupied)};
    Belief belief{.world = "w1", .wall_probability = BeliefGrid(3, 6, 1.0F)};
    for (int column = 1; column < 5; ++column) {
      map.cells[{1, column}] = Occupancy::kFree;
      belief.wall_probability[{1, column}] = 0.0F;
    }
    bus::Send(map_, ToMessage(map));
    bus::Send(belief_, ToMessage(belief));
    const Guidance guidance{.world = "w1",
                            .robot = "r1",
                            .revision = 1,
                            .path = {{1, 1}, {1, 2}, {1, 3}, {1, 4}},
                            .given_by = "test",
                            .valid_until = SimTime{} + 600s};
    bus::Send(guidance_, ToMessage(guidance));
    sensor_msgs::msg::CameraInfo camera;
    camera.width(320);
    camera.height(192);
    camera.k({114.4, 0.0, 160.0, 0.0, 114.4, 96.0, 0.0, 0.0, 1.0});
    bus::Send(camera_info_, camera);
    PublishState();
  }

  void PublishGoalPose(Position goal) {
    geometry_msgs::msg::PoseStamped message;
    message.header(ToHeader({}));
    message.pose().position().x(goal.x_m);
    message.pose().position().y(goal.y_m);
    bus::Send(goal_pose_, message);
  }

  /// Number of poses of the newest plan; 0 when none was published.
  std::size_t PlanLength() {
    const auto plans = plan_.Take();
    return plans.empty() ? 0 : plans.back().poses().size();
  }

  /// The next command, waited for with a deadline.
  std::optional<RobotCommand> NextCommand() {
    const auto deadline = std::chrono::steady_clock::now() + 30s;
    while (std::chrono::steady_clock::now() < deadline) {
      const auto commands =
          command_.TakeValid([](const auto& message) { return ToDomain(message); });
      if (!commands.empty()) return commands.back();
      tester_.Wait(100ms);
    }
    return std::nullopt;
  }

  void PublishState() {
    bus::Send(goals_, ToMessage(GoalsOf(state, 0.5)));
    bus::Send(state_, ToMessage(state));
  }
  Cell TargetOf(const RobotCommand& command) const {
    return state.grid.PositionToCell(command.path.at(0));
  }

  RobotState state{.world = "w1",
                   .robot = "r1",
                   .grid = {3, 6, 2.0},
                   .cell = {1, 1},
                   .goals_stamp = {1},
                   .goals_left = {{1, 4}},
                   .goals_total = 1,
                   .path = {{1, 1}}};

 private:
  static planner::PlannerConfig ConfigOf(const std::string& method) {
    planner::PlannerConfig config;
    config.method = ParseMethod(method).value();
    config.perception = "embedded";
    config.search.options.iterations = 200;
    return config;
  }

  std::shared_ptr<bus::InMemoryBus> bus_ = std::make_shared<bus::InMemoryBus>();
  bus::Participant tester_{"tester", bus_};
  bus::Publisher<conav_msgs::msg::RobotState> state_{tester_, bus::kRobotState, "r1"};
  bus::Publisher<conav_msgs::msg::RobotGoals> goals_{tester_, bus::kRobotGoals, "r1"};
  bus::Publisher<nav_msgs::msg::OccupancyGrid> map_{tester_, bus::kRobotMap, "r1"};
  bus::Publisher<conav_msgs::msg::BeliefMap> belief_{tester_, bus::kBelief, "w1"};
  bus::Publisher<conav_msgs::msg::Guidance> guidance_{tester_, bus::kGuidance, "r1"};
  bus::Publisher<sensor_msgs::msg::CameraInfo> camera_info_{tester_, bus::kCameraInfo, "r1"};
  bus::Publisher<geometry_msgs::msg::PoseStamped> goal_pose_{tester_, bus::kGoalPose, "r1"};
  bus::Subscriber<nav_msgs::msg::Path> plan_{tester_, bus::kPlan, "r1"};
  bus::Subscriber<conav_msgs::msg::RobotCommand> command_{tester_, bus::kRobotCommand, "r1"};
  SteadyClock clock_;
  StopToken stop_;
  bus::Participant planner_participant_{"planner", bus_};
  planner::PlannerService planner_;
  std::thread thread_;
};

}  // namespace

TEST_CASE("each method that decides answers a complete situation with the step along the path",
          "[planner][integration]") {
  const std::string method = GENERATE("ig-mcts", "instruction", "greedy");
  PlannerOnBus planner(method);
  planner.PublishAll();
  const auto command = planner.NextCommand();
  REQUIRE(command);
  CHECK(command->kind == CommandKind::kMove);
  CHECK(planner.TargetOf(*command) == Cell{1, 2});
  CHECK(command->sequence_number == 1);
  CHECK(command->lease_epoch == 1);
  CHECK(command->expires_at > SimTime{});
  CHECK(planner.PlanLength() >= 1);
}

TEST_CASE("a goal pose from RViz moves the robot towards it", "[planner][integration]") {
  PlannerOnBus planner("instruction");
  planner.PublishAll();
  REQUIRE(planner.NextCommand());
  // The order is carried out; before the robot says so, somebody points back at cell (1,1).
  planner.PublishGoalPose({-3.0, 0.0});
  planner.state.stamp = SimTime{} + 1s;
  planner.state.cell = {1, 2};
  planner.state.path = {{1, 1}, {1, 2}};
  planner.state.lease_epoch = 1;
  planner.state.command_sequence_number = 1;
  planner.state.command_outcome = CommandOutcome::kDone;
  planner.PublishState();
  auto command = planner.NextCommand();
  // On a slow machine the first one may have been sent again meanwhile.
  while (command && command->sequence_number == 1) command = planner.NextCommand();
  REQUIRE(command);
  CHECK(planner.TargetOf(*command) == Cell{1, 1});
}
