#include <catch2/catch.hpp>
#include <memory>

#include "common/runtime/log.h"
#include "integration/operator/hand_made_sim.h"
#include "operator/simulated/operator_client.h"

// Robots that are not the simulator's: their goals, maps and stops.
namespace conav::operators {
namespace {

using namespace std::chrono_literals;

const std::vector<std::string> kFieldMap{"######", "#    #", "# ## #", "#    #", "######"};

/// The service, and a robot that does not keep its goals in a map of 5 x 6 cells of 1.5 m, whose
/// south-west corner is (20, 30).
struct FieldBench {
  explicit FieldBench(const std::string& mission = "") {
    config.database = (folder / "operator.db").string();
    config.goals.robots = {"r1"};
    if (!mission.empty()) config.goals.mission = folder.Write("mission.yaml", mission).string();
    Start();
    REQUIRE(initial_map.Publish(
        ToMessage(MapUpdate{{0}, 1.5, DrawnTruth(kFieldMap), state.grid.middle})));
    service->Step();
  }
  void Start() {
    service.reset();
    service.emplace(operator_participant, config, clock);
  }

  void Report(Cell cell) {
    state.stamp.nanoseconds += 100;
    state.cell = cell;
    state.position = state.grid.CellToPosition(cell);
    state.path = {cell};
    REQUIRE(states.Publish(ToMessage(state)));
    service->Step();
  }
  void PublishGoalPose(double x_m, double y_m) {
    geometry_msgs::msg::PoseStamped pose;
    pose.header(ToHeader({}));
    pose.pose().position().x(x_m);
    pose.pose().position().y(y_m);
    REQUIRE(goal_pose.Publish(pose));
    service->Step();
  }
  OperatorReply Ask(const decltype(OperatorRequest::body)& body) {
    const std::uint64_t id = client.Send("w1", body, {});
    service->Step();
    for (const auto& outcome : client.Poll()) {
      if (outcome.request_id == id) return outcome.reply.value();
    }
    FAIL("no reply to request " << id);
    return {};
  }
  std::optional<RobotGoals> TakeGoals() {
    auto all = goals.TakeValid([](const auto& message) { return ToDomain(message); });
    return all.empty() ? std::nullopt : std::optional(all.back());
  }
  /// Ends the service after a look at the health; the keys of its alerts.
  std::vector<std::string> EndWithAlerts() {
    clock.Advance(1s);
    service->Step();
    service.reset();
    std::vector<std::string> keys;
    const BeliefStore store({{config.database, 0}, {}});
    for (const Alert& alert : store.alerts()) keys.push_back(alert.condition.key);
    return keys;
  }

  TemporaryFolder folder;
  std::shared_ptr<bus::InMemoryBus> bus = std::make_shared<bus::InMemoryBus>();
  FakeClock clock;
  bus::Participant robot{"robot", bus};
  bus::Participant operator_participant{"operator", bus};
  bus::Publisher<nav_msgs::msg::OccupancyGrid> initial_map{robot, bus::kInitialMap, "w1"};
  bus::Publisher<conav_msgs::msg::RobotState> states{robot, bus::kRobotState, "r1"};
  bus::Publisher<geometry_msgs::msg::PoseStamped> goal_pose{robot, bus::kGoalPose, "r1"};
  bus::Subscriber<conav_msgs::msg::RobotGoals> goals{robot, bus::kRobotGoals, "r1"};
  bus::Subscriber<conav_msgs::msg::BeliefMap> belief{robot, bus::kBelief, "w1"};
  bus::Subscriber<conav_msgs::msg::StopOrder> stop{robot, bus::kStopOrder, "r1"};
  OperatorClient client{robot, clock, {"anna", 0.25, 10.0}};
  RobotState state{.world = "w1", .robot = "r1", .grid = {5, 6, 1.5, {20.0 + 4.5, 30.0 + 3.75}}};
  OperatorConfig config;
  std::optional<OperatorService> service;
};

TEST_CASE("a robot of the field gets its goals from a mission, from clients and from RViz",
          "[operator][field][integration]") {
  FieldBench bench("r1: [[22.3, 35.2], [27.7, 31.6]]");  // cells (1, 1) and (3, 5)
  CHECK_FALSE(bench.TakeGoals());
  CHECK_FALSE(bench.Ask(GoalsRequest{"r1", {{25.0, 35.0}}, {}}).accepted);  // not here yet
  bench.Report({3, 1});
  CHECK(bench.TakeGoals()->left.size() == 2);
  CHECK(bench.Ask(GoalsRequest{"r1", {{25.0, 35.0}}, {{27.7, 31.6}}}).accepted);
  CHECK(bench.TakeGoals()->left == std::vector<Position>{{22.3, 35.2}, {25.0, 35.0}});
  bench.Report({1, 1});
  const RobotGoals reached = *bench.TakeGoals();
  CHECK(reached.left == std::vector<Position>{{25.0, 35.0}});
  CHECK(reached.reached == std::vector<Position>{{22.3, 35.2}});
  CHECK(reached.total == 2);
  // The operator service starts again: nothing is lost, nothing is visited twice.
  bench.Start();
  bench.Report({1, 2});
  CHECK(bench.TakeGoals()->left == std::vector<Position>{{25.0, 35.0}});

  bench.PublishGoalPose(23.0, 31.0);
  CHECK(bench.TakeGoals()->left == std::vector<Position>{{23.0, 31.0}});
  const auto refused = bench.Ask(GoalsRequest{"r1", {{0.0, 0.0}}, {}});
  CHECK_THAT(refused.reason, Catch::Contains("5x6 cells"));
  CHECK(bench.EndWithAlerts() == std::vector<std::string>{"restarted/operator"});
}

/// Lines about goal poses that `call` logs.
template <class Call>
std::vector<std::string> LinesOf(const Call& call) {
  std::vector<std::string> lines;
  log::SetSink([&lines](const log::Record& record) {
    if (record.text.starts_with("goal pose")) lines.emplace_back(record.text);
  });
  call();
  log::SetSink(nullptr);
  return lines;
}

TEST_CASE("a goal pose that nobody takes is a warning that names robot, topic and key",
          "[operator][field][integration]") {
  FieldBench bench;
  bench.config.goals.robots.clear();
  bench.Start();
  bench.Report({1, 1});
  const auto click = [&] { bench.PublishGoalPose(23.0, 31.0); };
  SECTION("of a robot in the field, once in a while") {
    const auto lines = LinesOf([&] {
      for (int i = 0; i < 3; ++i) click();
    });
    REQUIRE(lines.size() == 1);
    CHECK_THAT(lines[0], Catch::Contains("robot=r1") && Catch::Contains("/r1/goal_pose") &&
                             Catch::Contains("operator.goals.robots"));
    CHECK_FALSE(bench.TakeGoals());
    bench.clock.Advance(20s);
    CHECK(LinesOf(click).size() == 1);
  }
  SECTION("not of one that keeps its goals: its planner takes it as guidance") {
    bus::Publisher<conav_msgs::msg::RobotGoals> keeper(bench.robot, bus::kRobotGoals, "r1");
    REQUIRE(keeper.Publish(ToMessage(RobotGoals{.stamp = {7}, .world = "w1", .robot = "r1"})));
    bench.state.goals_stamp = {7};
    bench.Report({1, 1});
    CHECK(LinesOf(click).empty());
  }
}

TEST_CASE("two writers of a robot's goals are an alert, and the service does not join in",
          "[operator][field][integration]") {
  FieldBench bench;
  std::optional<bus::Publisher<conav_msgs::msg::RobotGoals>> other;
  other.emplace(bench.robot, bus::kRobotGoals, "r1");
  SECTION("another program was there first") {
    bench.Report({1, 1});
    CHECK_FALSE(bench.TakeGoals());
    CHECK_THAT(bench.Ask(GoalsRequest{"r1", {{25.0, 35.0}}, {}}).reason,
               Catch::Contains("another program"));
    CHECK(bench.service.has_value());
    bench.clock.Advance(20s);
    bench.Report({1, 1});
    CHECK(bench.EndWithAlerts().at(0) == "goals/r1");
  }
  SECTION("it goes: its killed process is no alert, and the goals are published") {
    bench.Report({1, 1});
    other.reset();
    bench.Report({1, 1});
    CHECK(bench.TakeGoals());
    CHECK(bench.EndWithAlerts() == std::vector<std::string>{});
  }
  SECTION("the robot keeps its goals itself") {
    bench.state.goals_stamp = {7};
    REQUIRE(other->Publish(ToMessage(RobotGoals{.stamp = {7}, .world = "w1", .robot = "r1"})));
    bench.Report({1, 1});
    CHECK_THAT(bench.Ask(GoalsRequest{"r1", {{25.0, 35.0}}, {}}).reason,
               Catch::Contains("another program") || Catch::Contains("keeps"));
    CHECK(bench.EndWithAlerts() == std::vector<std::string>{"goals/r1"});
  }
}

TEST_CASE("the belief lies where the initial map lies, a robot with other cells is refused",
          "[operator][field][integration]") {
  FieldBench bench;
  const auto beliefs = bench.belief.TakeValid([](const auto& m) { return ToDomain(m); });
  REQUIRE_FALSE(beliefs.empty());
  CHECK(beliefs.back().geometry() == bench.state.grid);
  bench.state.grid.middle = {};
  bench.Report({1, 1});
  CHECK_FALSE(bench.Ask(GuideRequest{"r1", {{1, 1}}, 0, 1.0}).accepted);
  CHECK_FALSE(bench.TakeGoals());
  CHECK(bench.EndWithAlerts() == std::vector<std::string>{"map/r1"});
}

// The faults report's S1: "The console keeps saying 'stopped'; a second STOP is answered `accepted` and
// does nothing, because nothing is published when the book believes that it is stopped."
TEST_CASE("each stop is an order, and a robot that does not confirm it is an alarm",
          "[operator][field][integration]") {
  const bool confirms = GENERATE(true, false);
  FieldBench bench;
  bench.Report({1, 1});
  for (std::uint64_t revision = 1; revision <= 2; ++revision) {
    REQUIRE(bench.Ask(StopRequest{{"r1"}, "people"}).accepted);
    const auto orders = bench.stop.TakeValid([](const auto& m) { return ToDomain(m); });
    REQUIRE(orders.size() == 1);
    CHECK(orders[0].stopped);
    CHECK(orders[0].revision == revision);
    bench.state.stopped = confirms;
    bench.state.stop_revision = confirms ? revision : 0;
    bench.Report({1, 1});
  }
  bench.clock.Advance(1s);
  bench.Report({1, 1});
  const std::vector<std::string> alarms = bench.EndWithAlerts();  // 2 s after the first order
  CHECK(alarms == (confirms ? std::vector<std::string>{} : std::vector<std::string>{"stop/r1"}));
}

// The same: "Forged HoldOrder{stopped:false} lets a stopped robot drive."
TEST_CASE("another program that resumes a stopped robot raises an alert",
          "[operator][field][integration]") {
  FieldBench bench;
  bench.Report({1, 1});
  REQUIRE(bench.Ask(StopRequest{{"r1"}, "people"}).accepted);
  bench.state.stopped = true;
  bench.state.stop_revision = 1;
  bench.Report({1, 1});
  bench.state.stopped = false;  // an order of revision 5 of somebody else
  bench.state.stop_revision = 5;
  bench.Report({1, 1});
  const auto orders = bench.stop.TakeValid([](const auto& m) { return ToDomain(m); });
  REQUIRE_FALSE(orders.empty());
  CHECK(orders.back().stopped);
  CHECK(orders.back().revision == 6);
  bench.state.stopped = true;
  bench.state.stop_revision = 6;
  bench.Report({1, 1});
  CHECK(bench.EndWithAlerts() == std::vector<std::string>{"resumed/r1"});
}

TEST_CASE("a configuration whose goals cannot be used stops the start",
          "[operator][field][integration]") {
  FieldBench bench;
  bench.service.reset();
  bench.config.goals.robots = {"r7"};
  CHECK_THROWS_WITH(bench.Start(), Catch::Contains("r7"));
  bench.config.goals.robots = {"r1"};
  bench.config.goals.mission = bench.folder.Write("bad.yaml", "r1:\n  - [1]\n").string();
  CHECK_THROWS_WITH(bench.Start(), Catch::Contains("bad.yaml:2"));
}

}  // namespace
}  // namespace conav::operators
