#include <catch2/catch.hpp>
#include <cmath>
#include <csignal>
#include <fstream>

#include "common/bus/participant.h"
#include "common/bus/publisher.h"
#include "common/bus/subscriber.h"
#include "common/msg/convert.h"
#include "operator/config.h"
#include "operator/simulated/operator_client.h"
#include "planner/config.h"
#include "robot/command_gate.h"
#include "support/loopback.h"
#include "support/service_process.h"
#include "support/temporary_folder.h"

namespace conav::robot {
namespace {

using namespace std::chrono_literals;
using std::chrono::steady_clock;

/// A driver that is not the simulator: a robot that drives straight at 4 m/s through a hall of 8 x 12
/// cells of 0.5 m with a wall in it, whose south-west corner is (100, -50). It keeps no goals; its
/// pictures have no pixels. The operator starts without the wall.
class FieldRobot {
 public:
  explicit FieldRobot(const bus::ParticipantOptions& options) : FieldRobot(options, {1}, {1, 1}) {}
  /// A driver that starts again: its time goes on and the robot stands where it stood.
  FieldRobot(const bus::ParticipantOptions& options, SimTime now, Cell cell)
      : now_(now),
        cell_(cell),
        participant_("driver", options),
        initial_map_(participant_, bus::kInitialMap, "w1"),
        map_(participant_, bus::kRobotMap, "r1"),
        camera_info_(participant_, bus::kCameraInfo, "r1"),
        states_(participant_, bus::kRobotState, "r1"),
        snapshots_(participant_, bus::kSnapshot, "r1"),
        commands_(participant_, bus::kRobotCommand, "r1"),
        stops_(participant_, bus::kStopOrder, "r1") {
    hall_.cells = OccupancyGrid(8, 12, Occupancy::kFree);
    for (std::size_t i = 0; i < hall_.cells.size(); ++i) {
      if (hall_.cells.OnBorder(hall_.cells.CellAt(i))) hall_.cells.values()[i] = kWall;
    }
    bus::Send(initial_map_, ToMessage(hall_));
    for (int row = 1; row < 6; ++row) hall_.cells[{row, 6}] = kWall;
    bus::Send(map_, ToMessage(hall_));
    sensor_msgs::msg::CameraInfo camera;
    camera.width(kWidth);
    camera.height(kHeight);
    camera.k({114.4, 0.0, 160.0, 0.0, 114.4, 96.0, 0.0, 0.0, 1.0});
    bus::Send(camera_info_, camera);
    place_ = grid_.CellToPosition(cell_);
    path_ = {cell_};
  }

  const GridGeometry& grid() const { return grid_; }
  SimTime now() const { return now_; }
  Cell cell() const { return cell_; }
  bool stopped() const { return gate_.stopped(); }
  std::uint64_t pictures() const { return pictures_; }

  /// 0.05 s of its time.
  void Step() {
    now_ = now_ + 50ms;
    for (const auto& order : stops_.TakeValid(kToDomain)) gate_.Receive(order);
    for (const auto& command : commands_.TakeValid(kToDomain)) {
      const auto admission = gate_.Receive(command, now_);
      if (!admission || *admission != CommandGate::Admission::kStarted) continue;
      if (command.kind == CommandKind::kMove) continue;
      if (command.kind == CommandKind::kTransmitView) {
        SendPicture();
        continue;
      }
      gate_.End(command.kind == CommandKind::kStop ? CommandOutcome::kDone
                                                   : CommandOutcome::kRefused);
    }
    gate_.EndIfExpired(now_);
    if (gate_.active()) Drive();
    Publish();
    participant_.Wait(10ms);
  }
  /// Until `done`, a minute at most.
  template <class Done>
  bool StepUntil(const Done& done) {
    const auto deadline = steady_clock::now() + 60s;
    while (!done() && steady_clock::now() < deadline) Step();
    return done();
  }
  bool IsIn(Position place) const {
    return cell_ == grid_.PositionToCell(place) && !gate_.active();
  }

 private:
  void Drive() {
    const Position to = gate_.command().path.back();
    const double left_m = std::hypot(to.x_m - place_.x_m, to.y_m - place_.y_m);
    const double step_m = std::min(0.2, left_m);
    if (left_m > 0.0) {
      place_.x_m += step_m * (to.x_m - place_.x_m) / left_m;
      place_.y_m += step_m * (to.y_m - place_.y_m) / left_m;
    }
    if (left_m - step_m > gate_.command().tolerance_m) return;
    cell_ = grid_.PositionToCell(place_);
    path_.push_back(cell_);
    ++moves_;
    gate_.End(CommandOutcome::kDone);
  }
  void SendPicture() {
    Snapshot picture{.stamp = now_,
                     .world = "w1",
                     .robot = "r1",
                     .sequence_number = ++pictures_,
                     .grid = grid_,
                     .cell = cell_,
                     .position = place_,
                     .heading_rad = gate_.command().heading_rad,
                     .width = kWidth,
                     .height = kHeight,
                     .path = path_};
    const CameraView view = ViewAt(cell_, picture.heading_rad, grid_.cell_size_m, kWidth, kHeight);
    picture.horizontal_fov_rad = view.horizontal_fov_rad;
    picture.visible = CastView(hall_.cells, view);
    bus::Send(snapshots_, ToMessage(picture));
    path_ = {cell_};
    gate_.End(CommandOutcome::kDone);
  }
  void Publish() {
    RobotState state{.stamp = now_,
                     .world = "w1",
                     .robot = "r1",
                     .grid = grid_,
                     .cell = cell_,
                     .position = place_,
                     .path = path_,
                     .cell_moves = moves_,
                     .snapshots = pictures_,
                     .map_stamp = {1}};
    gate_.Report(state);
    bus::Send(states_, ToMessage(state));
  }

  static constexpr Occupancy kWall = Occupancy::kOccupied;
  static constexpr int kWidth = 320;
  static constexpr int kHeight = 192;

  GridGeometry grid_{8, 12, 0.5, {100.0 + 3.0, -50.0 + 2.0}};
  MapUpdate hall_{{1}, 0.5, {}, grid_.middle};
  CommandGate gate_{"r1"};
  SimTime now_;
  Position place_;
  Cell cell_;
  std::vector<Cell> path_;
  std::uint64_t moves_ = 0;
  std::uint64_t pictures_ = 0;
  bus::Participant participant_;
  bus::Publisher<nav_msgs::msg::OccupancyGrid> initial_map_;
  bus::Publisher<nav_msgs::msg::OccupancyGrid> map_;
  bus::Publisher<sensor_msgs::msg::CameraInfo> camera_info_;
  bus::Publisher<conav_msgs::msg::RobotState> states_;
  bus::Publisher<conav_msgs::msg::Snapshot> snapshots_;
  bus::Subscriber<conav_msgs::msg::RobotCommand> commands_;
  bus::Subscriber<conav_msgs::msg::StopOrder> stops_;
};

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
