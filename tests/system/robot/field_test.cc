#include <catch2/catch.hpp>
#include <csignal>
#include <fstream>

#include "operator/config.h"
#include "operator/simulated/operator_client.h"
#include "planner/config.h"
#include "support/loopback.h"
#include "support/service_process.h"
#include "support/temporary_folder.h"
#include "system/robot/field_robot.h"

namespace conav::robot {
namespace {

using namespace std::chrono_literals;
using test::FieldRobot;

/// The robot, an operator service that keeps its goals, a planner, and a client.
struct Field {
  explicit Field(const std::string& vendor, planner::PlannerConfig planner_config = {})
      : options(test::OnLoopback(vendor)) {
    robot.emplace(options);
    operators::OperatorConfig operator_config;
    operator_config.bus = options;
    operator_config.database = (folder / "operator.db").string();
    operator_config.goals.robots = {"r1"};
    const Position first = Place({6, 2});
    const Position second = Place({1, 10});  // behind the wall
    operator_config.goals.mission =
        folder
            .Write("mission.yaml", fmt::format("r1: [[{}, {}], [{}, {}]]", first.x_m, first.y_m,
                                               second.x_m, second.y_m))
            .string();
    std::ofstream(folder / "operator.yaml") << DumpConfig("operator", operator_config);
    planner_config.bus = options;
    std::ofstream(folder / "planner.yaml") << DumpConfig("planner", planner_config);
    StartOperator();
    planner.emplace("conav-planner", folder / "planner.yaml");
  }

  Position Place(Cell cell) const { return robot->grid().CellToPosition(cell); }
  void StartOperator() { operator_service.emplace("conav-operator", folder / "operator.yaml"); }
  void RestartDriver() {
    const SimTime now = robot->now();
    const Cell cell = robot->cell();
    robot.reset();
    robot.emplace(options, now, cell);
  }
  /// Whether the operator service accepts it.
  bool Accepts(decltype(OperatorRequest::body) body) {
    client.Send("w1", std::move(body), {});
    std::optional<bool> accepted;
    robot->StepUntil([&] {
      for (const auto& outcome : client.Poll()) accepted = outcome.reply && outcome.reply->accepted;
      return accepted.has_value();
    });
    return accepted == true;
  }
  int Left() {
    for (RobotGoals& one : goals.TakeValid(kToDomain)) newest = std::move(one);
    return newest ? static_cast<int>(newest->left.size()) : -1;
  }
  bool ComesToLeave(int count) {
    return robot->StepUntil([&] { return Left() == count; });
  }

  const test::TemporaryFolder folder;
  bus::ParticipantOptions options;
  std::optional<FieldRobot> robot;
  std::optional<test::ServiceProcess> operator_service;
  std::optional<test::ServiceProcess> planner;
  bus::Participant person{"person", options};
  SteadyClock clock;
  operators::OperatorClient client{person, clock, {"anna", 0.25, 30.0}};
  bus::Subscriber<conav_msgs::msg::RobotGoals> goals{person, bus::kRobotGoals, "r1"};
  std::optional<RobotGoals> newest;
};

planner::PlannerConfig Greedy() {
  planner::PlannerConfig config;
  config.method = MethodKind::kGreedy;
  return config;
}

TEST_CASE(
    "a robot of the field, on a map of its own origin, is driven to a mission's and a client's "
    "goals",
    "[robot][field][system]") {
  Field field(GENERATE("cyclonedds", "fastdds"), Greedy());
  CHECK(field.ComesToLeave(0));
  REQUIRE(field.newest);
  CHECK(field.newest->reached.size() == 2);
  const Position third = field.Place({3, 1});
  CHECK(field.Accepts(GoalsRequest{"r1", {third}, {}}));
  CHECK(field.robot->StepUntil([&] { return field.Left() == 0 && field.robot->IsIn(third); }));
  CHECK(field.newest->reached.size() == 3);
  CHECK(field.planner->End(SIGTERM).exit_code == 0);
  CHECK(field.operator_service->End(SIGTERM).exit_code == 0);
}

TEST_CASE("a driver that starts again is driven on, and takes up the stop of the operator service",
          "[robot][field][system]") {
  Field field(GENERATE("cyclonedds", "fastdds"), Greedy());
  CHECK(field.ComesToLeave(1));
  field.RestartDriver();
  CHECK(field.ComesToLeave(0));
  const auto comes_to_stand = [&] {
    return field.robot->StepUntil([&] { return field.robot->stopped(); });
  };
  CHECK(field.Accepts(StopRequest{{"r1"}, "a check"}));
  CHECK(comes_to_stand());
  field.RestartDriver();
  CHECK(comes_to_stand());
  const Position third = field.Place({3, 1});
  CHECK(field.Accepts(GoalsRequest{"r1", {third}, {}}));
  // Without the operator service nothing stops it but the planner, which has received the order.
  CHECK(field.operator_service->End(SIGTERM).exit_code == 0);
  field.RestartDriver();
  const Cell there = field.robot->cell();
  for (int i = 0; i < 200; ++i) field.robot->Step();
  CHECK_FALSE(field.robot->stopped());
  CHECK(field.robot->cell() == there);
  field.StartOperator();
  CHECK(comes_to_stand());
  CHECK(field.Accepts(ResumeRequest{{"r1"}}));
  CHECK(field.robot->StepUntil([&] { return field.Left() == 0 && field.robot->IsIn(third); }));
}

TEST_CASE("a robot of the field sends the pictures that the planner asks for",
          "[robot][field][system]") {
  planner::PlannerConfig config;  // ig-mcts
  config.perception = "embedded";
  config.perception_model = PerceptionModelKind::kGlpf;
  config.communication.policy = "every";
  config.communication.every_moves = 4;
  config.first_guidance_timeout_s = 0.0;
  config.answer_timeout_s = 0.0;
  config.search.options.iterations = 50;
  Field field("cyclonedds", config);
  bus::Subscriber<conav_msgs::msg::Snapshot> snapshots(field.person, bus::kSnapshot, "r1");
  CHECK(field.ComesToLeave(0));
  CHECK(field.robot->pictures() >= 2);
  std::vector<Snapshot> came;
  CHECK(field.robot->StepUntil([&] {
    for (Snapshot& picture : snapshots.TakeValid(kToDomain)) came.push_back(std::move(picture));
    return came.size() == field.robot->pictures();
  }));
  REQUIRE_FALSE(came.empty());
  CHECK(came.back().sequence_number == came.size());
  CHECK_FALSE(came.back().visible.free.empty());
}

}  // namespace
}  // namespace conav::robot
