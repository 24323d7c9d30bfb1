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

using test::FieldRobot;

TEST_CASE(
    "a robot of the field, on a map of its own origin, is driven to a mission's and a client's "
    "goals",
    "[robot][field][system]") {
  const std::string vendor = GENERATE("cyclonedds", "fastdds");
  const test::TemporaryFolder folder;
  const bus::ParticipantOptions options = test::OnLoopback(vendor);
  FieldRobot robot(options);
  const Position first = robot.grid().CellToPosition({6, 2});
  const Position second = robot.grid().CellToPosition({1, 10});  // behind the wall
  operators::OperatorConfig operator_config;
  operator_config.bus = options;
  operator_config.database = (folder / "operator.db").string();
  operator_config.goals.robots = {"r1"};
  operator_config.goals.mission =
      folder
          .Write("mission.yaml", fmt::format("r1: [[{}, {}], [{}, {}]]", first.x_m, first.y_m,
                                             second.x_m, second.y_m))
          .string();
  std::ofstream(folder / "operator.yaml") << DumpConfig("operator", operator_config);
  planner::PlannerConfig planner_config;
  planner_config.bus = options;
  planner_config.method = MethodKind::kGreedy;
  std::ofstream(folder / "planner.yaml") << DumpConfig("planner", planner_config);
  test::ServiceProcess operator_service("conav-operator", folder / "operator.yaml");
  test::ServiceProcess planner("conav-planner", folder / "planner.yaml");
  bus::Subscriber<conav_msgs::msg::RobotGoals> goals(robot.participant(), bus::kRobotGoals, "r1");
  std::optional<RobotGoals> newest;
  const auto left = [&] {
    for (RobotGoals& one : goals.TakeValid(kToDomain)) newest = std::move(one);
    return newest ? static_cast<int>(newest->left.size()) : -1;
  };

  CHECK(robot.StepUntil([&] { return left() == 0; }));
  REQUIRE(newest);
  CHECK(newest->reached.size() == 2);

  SteadyClock clock;
  operators::OperatorClient client(robot.participant(), clock, {"anna", 0.25, 30.0});
  const Position third = robot.grid().CellToPosition({3, 1});
  client.Send("w1", GoalsRequest{"r1", {third}, {}}, {});
  std::optional<bool> accepted;
  CHECK(robot.StepUntil([&] {
    for (const auto& outcome : client.Poll()) accepted = outcome.reply && outcome.reply->accepted;
    return accepted.has_value();
  }));
  CHECK(accepted == true);
  CHECK(robot.StepUntil([&] { return left() == 0 && robot.IsIn(third); }));
  CHECK(newest->reached.size() == 3);
  CHECK(planner.End(SIGTERM).exit_code == 0);
  CHECK(operator_service.End(SIGTERM).exit_code == 0);
}

}  // namespace
}  // namespace conav::robot
