#include <catch2/catch.hpp>
#include <csignal>
#include <fstream>
#include <nlohmann/json.hpp>

#include "common/bus/publisher.h"
#include "common/bus/subscriber.h"
#include "common/msg/convert.h"
#include "common/service/diagnostics.h"
#include "common/service/robot_state_topics.h"
#include "operator/config.h"
#include "planner/config.h"
#include "robot/driver/config.h"
#include "sim/config.h"
#include "support/loopback.h"
#include "support/program_runner.h"
#include "support/scoped_variable.h"
#include "support/service_process.h"
#include "system/robot/standin_robot.h"

// Report of 2026-11-22, row 38: "a robot of another make, standard types only: /r9/odom, map, tf, camera,
// /w1/initial_map | planner drives it | planner: no log line after 'running', waits for RobotState for
// ever | fail". Here the planner drives such robots to their goals.
namespace conav::robot {
namespace {

using namespace std::chrono_literals;
using std::chrono::steady_clock;
using test::Building;
using test::StandinRobot;

/// The plan's corner; its cells are 1 m.
constexpr double kX = 100.0;
constexpr double kY = -50.0;
constexpr int kRows = 10;
constexpr int kColumns = 14;

Building::Box Box(double x0, double y0, double x1, double y1) {
  return {kX + x0, kY + y0, kX + x1, kY + y1};
}

/// 14 x 10 m, three rooms: a thin wall exactly between two columns of cells, and one in the middle of
/// a column.
Building ThreeRooms() {
  return {{Box(0.0, 0.0, 14.0, 0.4), Box(0.0, 9.6, 14.0, 10.0), Box(0.0, 0.0, 0.4, 10.0),
           Box(13.6, 0.0, 14.0, 10.0), Box(4.95, 0.0, 5.05, 6.0), Box(9.4, 4.0, 9.5, 10.0)}};
}

/// What the operator starts from: of the two inner walls one is missing, the other in the wrong place.
MapUpdate Plan() {
  MapUpdate plan{{1},
                 1.0,
                 OccupancyGrid(kRows, kColumns, Occupancy::kFree),
                 {kX + kColumns / 2.0, kY + kRows / 2.0}};
  for (std::size_t i = 0; i < plan.cells.size(); ++i) {
    if (plan.cells.OnBorder(plan.cells.CellAt(i))) plan.cells.values()[i] = Occupancy::kOccupied;
  }
  for (int row = 4; row < 7; ++row) plan.cells[{row, 3}] = Occupancy::kOccupied;
  return plan;
}

DriverConfig ConfigFor(const std::string& robot, const StandinRobot::Options& standin,
                       const bus::ParticipantOptions& bus) {
  DriverConfig config;
  config.bus = bus;
  config.robot = robot;
  config.robot_namespace = standin.name;
  // A SLAM's map begins where the robot started.
  config.alignment = {standin.x, standin.y, standin.yaw * 57.29577951308232, {}, 0.5};
  config.move.by = standin.navigates       ? WayToMove::kNavigateToPose
                   : standin.follows_goals ? WayToMove::kGoalPose
                                           : WayToMove::kCmdVel;
  config.move.radius_m = 0.22;
  config.move.speed_mps = 0.8;
  config.move.turn_rps = 1.6;
  config.move.stamped = standin.stamped;
  config.move.stuck_s = 4.0;
  config.move.blocked_for_s = 5.0;
  config.map.timeout_s = 2.0;
  config.localisation.correction_timeout_s = 1.5;
  if (standin.prefixed_frames) {
    config.topics.tf = "/tf";
    config.topics.tf_static = "/tf_static";
    config.frames = {standin.name + "/map", standin.name + "/odom", standin.name + "/base_link"};
  }
  if (standin.raw_image) {
    config.topics.image = "camera/image_raw";
    config.topics.depth = "camera/depth";
  }
  if (standin.has_pan) {
    config.topics.pan = "pan/command";
    config.camera.pan_settle_s = 0.3;
  }
  return config;
}

/// The robots, each with its driver, and a person who looks at the bus.
struct Fleet {
  explicit Fleet(const std::string& vendor) : options(test::OnLoopback(vendor)) {
    person.emplace("person", options);
    initial_map.emplace(*person, bus::kInitialMap, "w1");
    diagnostics.emplace(*person, bus::kDiagnostics);
    bus::Send(*initial_map, ToMessage(Plan()));
  }

  StandinRobot& Add(const std::string& robot, const StandinRobot::Options& standin,
                    std::vector<std::string> others = {}) {
    robots.push_back(std::make_unique<StandinRobot>(options, building, standin));
    DriverConfig config = ConfigFor(robot, standin, options);
    config.others = std::move(others);
    config.use_sim_time = uses_sim_time;
    config.state_file = (folder / (robot + ".state")).string();
    std::ofstream(folder / (robot + ".yaml")) << DumpConfig("driver", config);
    drivers.push_back(
        std::make_unique<test::ServiceProcess>("conav-driver", folder / (robot + ".yaml")));
    goals.push_back(std::make_unique<bus::Subscriber<conav_msgs::msg::RobotGoals>>(
        *person, bus::kRobotGoals, robot));
    states.push_back(std::make_unique<bus::Subscriber<conav_msgs::msg::RobotState>>(
        *person, bus::kRobotState, robot));
    left.push_back(-1);
    newest.emplace_back();
    return *robots.back();
  }

  /// A planner and an operator service with these goals, one list for each robot in the field.
  void Supervise(const std::vector<std::string>& names, const std::string& mission,
                 const std::vector<std::string>& in_field) {
    operators::OperatorConfig operator_config;
    operator_config.bus = options;
    operator_config.robots = {};
    for (const std::string& name : names) operator_config.robots.push_back("w1/" + name);
    operator_config.database = (folder / "operator.db").string();
    operator_config.goals.robots = in_field;
    operator_config.goals.mission = folder.Write("mission.yaml", mission).string();
    std::ofstream(folder / "operator.yaml") << DumpConfig("operator", operator_config);
    planner::PlannerConfig planner_config;
    planner_config.bus = options;
    planner_config.robots = operator_config.robots;
    planner_config.method = MethodKind::kGreedy;
    std::ofstream(folder / "planner.yaml") << DumpConfig("planner", planner_config);
    services.push_back(
        std::make_unique<test::ServiceProcess>("conav-operator", folder / "operator.yaml"));
    services.push_back(
        std::make_unique<test::ServiceProcess>("conav-planner", folder / "planner.yaml"));
  }

  void Look() {
    for (std::size_t i = 0; i < goals.size(); ++i) {
      for (const RobotGoals& one : goals[i]->TakeValid(kToDomain)) {
        left[i] = static_cast<int>(one.left.size());
      }
      for (RobotState& state : states[i]->TakeValid(kToDomain)) newest[i] = std::move(state);
    }
    for (const auto& message : diagnostics->Take()) {
      for (const ReportedHealth& health : HealthOf(message)) said[health.process] = health.message;
      for (const auto& status : message.status()) {
        for (const auto& pair : status.values()) {
          if (pair.key() == "drift_m") drift_m[status.hardware_id()] = std::stod(pair.value());
        }
      }
    }
    for (std::size_t i = 0; i < robots.size(); ++i) {
      for (std::size_t k = 0; k < i; ++k) {
        const auto a = robots[i]->place();
        const auto b = robots[k]->place();
        nearest_m = std::min(nearest_m, std::hypot(a.x - b.x, a.y - b.y));
      }
    }
    person->Wait(20ms);
  }
  template <class Done>
  bool Until(const Done& done, std::chrono::seconds patience = 150s) {
    const auto deadline = steady_clock::now() + patience;
    while (!done() && steady_clock::now() < deadline) Look();
    return done();
  }
  /// The driver of `robot` says on /diagnostics that it stands because of this; the robot does.
  bool Stands(std::size_t index, const std::string& robot, const std::string& because) {
    const bool says =
        Until([&] { return said["driver_" + robot].find(because) != std::string::npos; }, 20s);
    CAPTURE(robot, because, said["driver_" + robot]);
    CHECK(says);
    const auto halted = steady_clock::now() + 1s;  // it brakes
    Until([&] { return steady_clock::now() > halted; });
    const auto before = robots[index]->place();
    const auto later = steady_clock::now() + 1s;
    Until([&] { return steady_clock::now() > later; });
    const auto after = robots[index]->place();
    return says && std::hypot(after.x - before.x, after.y - before.y) < 0.05;
  }

  bus::ParticipantOptions options;
  const test::TemporaryFolder folder;
  Building building = ThreeRooms();
  std::optional<bus::Participant> person;
  std::optional<bus::Publisher<nav_msgs::msg::OccupancyGrid>> initial_map;
  std::optional<bus::Subscriber<diagnostic_msgs::msg::DiagnosticArray>> diagnostics;
  std::vector<std::unique_ptr<StandinRobot>> robots;
  std::vector<std::unique_ptr<test::ServiceProcess>> drivers;
  std::vector<std::unique_ptr<test::ServiceProcess>> services;
  std::vector<std::unique_ptr<bus::Subscriber<conav_msgs::msg::RobotGoals>>> goals;
  std::vector<std::unique_ptr<bus::Subscriber<conav_msgs::msg::RobotState>>> states;
  std::vector<int> left;
  std::vector<std::optional<RobotState>> newest;
  std::map<std::string, std::string> said;
  std::map<std::string, double> drift_m;
  double nearest_m = 1e9;
  bool uses_sim_time = false;
};

StandinRobot::Options At(const std::string& name, double x, double y, double yaw = 0.0) {
  return {.name = name, .x = kX + x, .y = kY + y, .yaw = yaw};
}

TEST_CASE("a robot that speaks only ROS 2 keeps every clause of the contract through its driver",
          "[robot][driver][system]") {
  struct Row {
    std::string vendor;
    std::string kind;
  };
  const Row row = GENERATE(Row{"cyclonedds", "cmd_vel"}, Row{"fastdds", "all else"},
                           Row{"cyclonedds", "goal_pose"}, Row{"fastdds", "nav2"});
  CAPTURE(row.vendor, row.kind);
  Fleet fleet(row.vendor);
  StandinRobot::Options standin = At("tb3", 2.3, 7.4, 0.5);
  const bool all_else = row.kind == "all else";
  standin.raw_image = standin.prefixed_frames = standin.stamped = standin.has_pan = all_else;
  standin.follows_goals = row.kind == "goal_pose";
  standin.navigates = row.kind == "nav2";
  StandinRobot& robot = fleet.Add("r1", standin);
  REQUIRE(fleet.Until([&] { return fleet.newest[0].has_value(); }, 20s));
  const test::ProgramRunner doctor("conav-doctor");
  const auto outcome = doctor.Run(fmt::format(
      "robot r1 --domain {} --interface lo --json report.json", fleet.options.domain_id));
  CAPTURE(outcome.out, outcome.error);
  CHECK(outcome.exit_code == 0);
  const auto clauses = nlohmann::json::parse(ReadFile(doctor / "report.json").value())["clauses"];
  REQUIRE(clauses.size() == 23);
  for (const auto& clause : clauses) {
    CAPTURE(clause.dump());
    CHECK(clause["verdict"] == "holds");
  }
  CHECK(robot.bumps() == 0);
  if (all_else) CHECK(std::abs(robot.pan()) > 1.0);  // it looked aside without turning
  CHECK(fleet.drivers[0]->End(SIGTERM).exit_code == 0);
}

TEST_CASE("a driver that is killed is still stopped when it starts again, though nobody says so",
          "[robot][driver][system]") {
  Fleet fleet("cyclonedds");
  fleet.Add("r1", At("tb3", 2.3, 7.4));
  REQUIRE(fleet.Until([&] { return fleet.newest[0].has_value(); }, 20s));
  {
    bus::Publisher<conav_msgs::msg::StopOrder> stops(*fleet.person, bus::kStopOrder, "r1");
    bus::Send(stops,
              ToMessage(StopOrder{.world = "w1", .robot = "r1", .revision = 7, .stopped = true}));
    REQUIRE(fleet.Until([&] { return fleet.newest[0]->stopped; }, 20s));
  }
  fleet.drivers[0]->End(SIGKILL);
  const auto until = steady_clock::now() + 1s;  // what it sent before has come
  fleet.Until([&] { return steady_clock::now() > until; });
  fleet.newest[0].reset();
  fleet.drivers[0] =
      std::make_unique<test::ServiceProcess>("conav-driver", fleet.folder / "r1.yaml");
  REQUIRE(fleet.Until([&] { return fleet.newest[0].has_value(); }, 20s));
  CHECK(fleet.newest[0]->stopped);
  CHECK(fleet.newest[0]->stop_revision == 7);
}

void DriveThreeRobots(const std::string& vendor) {
  Fleet fleet(vendor);
  StandinRobot::Options second = At("tb2", 1.6, 4.4, 0.0);
  second.prefixed_frames = true;
  second.raw_image = true;
  second.map_resolution = 0.05;
  StandinRobot::Options third = At("tb3", 11.5, 7.5, -1.2);
  third.navigates = true;
  StandinRobot& one = fleet.Add("r1", At("tb1", 2.5, 1.5, 0.3), {"r2", "r3"});
  StandinRobot& two = fleet.Add("r2", second, {"r1", "r3"});
  StandinRobot& three = fleet.Add("r3", third, {"r1", "r2"});
  fleet.Supervise({"r1", "r2", "r3"},
                  fmt::format("r1: [[{}, {}], [{}, {}]]\n"
                              "r2: [[{}, {}], [{}, {}]]\n"
                              "r3: [[{}, {}], [{}, {}]]\n",
                              kX + 6.5, kY + 7.5, kX + 7.5, kY + 1.5,   //
                              kX + 2.5, kY + 7.5, kX + 12.5, kY + 1.5,  //
                              kX + 10.5, kY + 1.5, kX + 12.5, kY + 8.5),
                  {"r1", "r2", "r3"});
  REQUIRE(fleet.Until([&] { return fleet.left == std::vector<int>{2, 2, 2}; }, 30s));
  const auto moves = [&](const StandinRobot& robot) {
    const auto from = robot.place();
    return fleet.Until(
        [&] { return std::hypot(robot.place().x - from.x, robot.place().y - from.y) > 0.3; }, 30s);
  };
  REQUIRE(moves(one));
  one.faults.odometry_silent = true;
  CHECK(fleet.Stands(0, "r1", "odometry silent"));
  one.faults.odometry_silent = false;
  CHECK(moves(one));
  two.faults.map_silent = true;
  CHECK(fleet.Stands(1, "r2", "map: silent"));
  two.faults.map_silent = false;
  two.faults.base_gone = true;
  CHECK(fleet.Stands(1, "r2", "nobody listens on /tb2/cmd_vel"));
  two.faults.base_gone = false;
  three.faults.jumps = true;
  CHECK(fleet.Stands(2, "r3", "jumped by 3"));
  three.faults.aborts = true;
  const auto aborted = [&] {
    const auto& state = fleet.newest[2];
    return state->command_outcome == CommandOutcome::kRefused &&
           state->command_detail.find("error code 208") != std::string::npos;
  };
  CHECK(fleet.Until(aborted, 30s));
  three.faults.aborts = false;
  one.faults.correction_silent = true;
  CHECK(fleet.Stands(0, "r1", "correction silent"));
  one.faults.correction_silent = false;
  const bool done = fleet.Until([&] { return fleet.left == std::vector<int>{0, 0, 0}; });
  for (const auto& state : fleet.newest) {
    UNSCOPED_INFO(fmt::format("{} in {} outcome {} {} at {} epoch {} number {}", state->robot,
                              state->cell, static_cast<int>(state->command_outcome),
                              state->command_detail, state->command_cell, state->lease_epoch,
                              state->command_sequence_number));
  }
  CAPTURE(fleet.left, one.place().x - kX, one.place().y - kY, two.place().x - kX,
          two.place().y - kY, three.place().x - kX, three.place().y - kY);
  CHECK(done);
  CHECK(one.bumps() + two.bumps() + three.bumps() == 0);
  CHECK(fleet.nearest_m > 0.4);             // two radii
  CHECK(fleet.drift_m["driver_r1"] > 0.1);  // of odometry that counts three percent too much
  for (auto& driver : fleet.drivers) CHECK(driver->End(SIGTERM).exit_code == 0);
}

TEST_CASE(
    "three ROS 2 robots in one building are driven to all goals, with one fault after the other",
    "[robot][driver][system]") {
  DriveThreeRobots("cyclonedds");
}

TEST_CASE("the same on Fast DDS", "[.long]") { DriveThreeRobots("fastdds"); }

TEST_CASE("a driver does not start with what cannot be right, and names it",
          "[robot][driver][system]") {
  struct Row {
    std::string text;
    std::string names;
  };
  const Row row = GENERATE(
      Row{"{alignment: {pairs: [[0, 0, 0, 0], [4, 0, 4, 0], [0, 3, 0, -3]]}}", "off the best fit"},
      Row{"{alignment: {pairs: [[0, 0, 0, 0], [4, 0, 4, 0]]}}", "2 pairs"},
      Row{"{alignment: {pairs: [[0, 0, 0], [4, 0, 4, 0], [1, 2, 3, 4]]}}", "pairs[0]"},
      Row{"{namespace: r1}", "/r1/map"},
      Row{"{namespace: tb3, topics: {goal_pose: /r1/goal_pose}, move: {by: goal_pose}}",
          "goal_pose"},
      Row{"{namespace: tb3, topics: {odometry: '', tf: ''}}", "odometry"},
      Row{"{namespace: tb3, others: [r1]}", "r1"}, Row{"{move: {by: wings}}", "wings"},
      Row{"{namespace: tb3, state_file: torn.state}", "torn.state"},
      Row{"{namespace: tb3, state_file: r2.state}", "of robot r2"},
      Row{"{namespace: tb3, state_file: nowhere/r1.state}", "nowhere"});
  const test::ProgramRunner driver("conav-driver");
  std::ofstream(driver / "torn.state") << R"({"robot": "r1", "lease)";
  std::ofstream(driver / "r2.state")
      << R"({"robot": "r2", "lease_epoch": 1, "stop_revision": 1, "stopped": true})";
  std::ofstream(driver / "robot.yaml") << "driver: {ros__parameters: " << row.text << "}\n";
  const test::ScopedVariable domain("CONAV_DOMAIN", std::to_string(test::TestDomain()).c_str());
  const test::ScopedVariable interface("CONAV_INTERFACE", "lo");
  const auto outcome = driver.Run("--config robot.yaml");
  CAPTURE(row.text, outcome.error);
  CHECK(outcome.exit_code == 1);
  CHECK_THAT(outcome.error, Catch::Contains(row.names));
}

TEST_CASE("a simulated robot and one that speaks only ROS 2 share a world and its time",
          "[robot][driver][system]") {
  Fleet fleet("cyclonedds");
  fleet.initial_map.reset();  // the simulator's counts
  sim::SimConfig config;
  config.bus = fleet.options;
  config.camera.mode = "none";
  config.robots = {"r1"};
  config.goals_per_robot = 1;
  config.speed = 1.0;
  std::ofstream(fleet.folder / "sim.yaml") << DumpConfig("sim", config);
  fleet.services.push_back(
      std::make_unique<test::ServiceProcess>("conav-sim", fleet.folder / "sim.yaml"));
  bus::Subscriber<nav_msgs::msg::OccupancyGrid> truths(*fleet.person, bus::kTruth, "w1");
  RobotStateTopics simulated(*fleet.person, "r1");
  std::optional<MapUpdate> truth;
  std::optional<RobotState> first;
  std::optional<RobotState> newest;
  REQUIRE(fleet.Until(
      [&] {
        for (MapUpdate& one : truths.TakeValid(kToDomain)) truth = std::move(one);
        for (auto& one : simulated.TakeStamped()) newest = one.value;
        if (!first) first = newest;
        return truth && newest;
      },
      20s));
  // The building that the simulator has, for the other robot's lidar; it starts away from r1.
  const GridGeometry grid = truth->geometry();
  fleet.building.walls.clear();
  std::vector<Cell> free;
  for (std::size_t i = 0; i < truth->cells.size(); ++i) {
    const Cell cell = truth->cells.CellAt(i);
    const Position middle = grid.CellToPosition(cell);
    const double half = grid.cell_size_m / 2.0;
    if (truth->cells[cell] == Occupancy::kFree) {
      free.push_back(cell);
    } else {
      fleet.building.walls.push_back(
          {middle.x_m - half, middle.y_m - half, middle.x_m + half, middle.y_m + half});
    }
  }
  const auto away = [&](Cell cell) {
    return std::abs(cell.row - first->cell.row) + std::abs(cell.column - first->cell.column);
  };
  const Cell start = *std::ranges::max_element(free, {}, away);
  const auto near_start = [&](Cell cell) {
    return std::abs(cell.row - start.row) + std::abs(cell.column - start.column) == 3;
  };
  const auto goal_cell = std::ranges::find_if(free, near_start);
  REQUIRE(goal_cell != free.end());
  const Position goal = grid.CellToPosition(*goal_cell);
  const Position at = grid.CellToPosition(start);
  fleet.uses_sim_time = true;
  StandinRobot& robot = fleet.Add("r2", {.name = "tb3", .x = at.x_m, .y = at.y_m}, {"r1"});
  fleet.Supervise({"r1", "r2"}, fmt::format("r2: [[{}, {}]]\n", goal.x_m, goal.y_m), {"r2"});
  const bool done = fleet.Until([&] {
    for (auto& one : simulated.TakeStamped()) newest = one.value;
    return fleet.left == std::vector<int>{0} && newest->goals_left.empty();
  });
  CAPTURE(fleet.left, newest->goals_left.size(), newest->cell, robot.place().x, robot.place().y);
  CHECK(done);
  CHECK(robot.bumps() == 0);
  REQUIRE(fleet.newest[0]);
  CHECK(std::abs(fleet.newest[0]->stamp.ToSeconds() - newest->stamp.ToSeconds()) < 5.0);
}

}  // namespace
}  // namespace conav::robot
