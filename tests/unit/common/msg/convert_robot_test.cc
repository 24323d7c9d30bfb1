#include <cmath>

#include "unit/common/msg/convert_expectations.h"
#include "unit/common/msg/samples.h"

namespace conav {
namespace {

using samples::SampleCommand;
using samples::SampleGoals;
using samples::SampleSnapshot;
using samples::SampleState;
using Command = conav_msgs::msg::RobotCommand;
using Goals = conav_msgs::msg::RobotGoals;
using State = conav_msgs::msg::RobotState;
using SnapshotMessage = conav_msgs::msg::Snapshot;

TEST_CASE("Robot commands, states and snapshots survive the wire", "[convert]") {
  Snapshot without_camera = SampleSnapshot();
  without_camera.jpeg.clear();
  CHECK(ToMessage(without_camera).format() == "none");
  RobotState alone = SampleState();  // its goals travel on their own topic
  alone.goals_left.clear();
  alone.goals_reached.clear();
  alone.goals_total = 0;
  CheckRoundTrips(SampleCommand(), alone, SampleGoals(), SampleSnapshot(), without_camera);
}

TEST_CASE("On the wire a robot speaks of places in metres", "[convert]") {
  const State message = ToMessage(SampleState());  // 12 x 10 cells of 2 m around (0.5, -8)
  REQUIRE(message.path().size() == 2);
  CHECK(message.path()[1].x() == Approx(0.5 - 1.0));  // of (3,4)
  CHECK(message.path()[1].y() == Approx(-8.0 + 5.0));
  CHECK(message.pose().position().x() == 1.25);
  CHECK(message.map_info().width() == 10);
  CHECK(message.map_info().origin().position().y() == Approx(-8.0 - 12.0));
  const Goals goals = ToMessage(SampleGoals());
  CHECK(goals.left()[0].position().x() == Approx(0.5 - 5.0));  // of (1,2)
  CHECK(goals.left()[0].position().y() == Approx(-8.0 + 9.0));
}

TEST_CASE("The view of a snapshot is the piece of the map that it shows", "[convert]") {
  const auto view = ToMessage(SampleSnapshot()).view();  // free (2,2) (2,3), walls (1,3) (2,4)
  CHECK(view.info().width() == 3);
  CHECK(view.info().height() == 2);
  CHECK(view.data() == std::vector<std::int8_t>{0, 0, 100, -1, 100, -1});  // southern row first
  CHECK(view.info().origin().position().x() == Approx(-1.0 - 4.0));
  CHECK(view.info().origin().position().y() == Approx(3.0 + 1.0));
}

TEST_CASE("A state without a path is in the cell of its pose", "[convert]") {
  State message = ToMessage(SampleState());
  message.path().clear();
  CHECK(ToDomain(message).value().cell == Cell{3, 5});
}

TEST_CASE("A state is joined with the goals that belong to it", "[goals]") {
  const RobotState state = SampleState();
  RobotState bare = state;
  bare.goals_left.clear();
  bare.goals_reached.clear();
  bare.goals_total = 0;
  RobotGoals older = SampleGoals();
  older.stamp = SimTime{1};
  older.left.clear();
  GoalsJoin join;
  CHECK_FALSE(join.Receive(older));
  CHECK_FALSE(join.Receive(bare));  // its goals are on the way
  CHECK(join.Receive(SampleGoals()) == state);
  CHECK(join.Receive(bare) == state);
  CHECK_FALSE(join.Receive(older));
  // In the field the robot does not keep its goals: the newest count.
  bare.goals_stamp = {};
  CHECK(join.Receive(bare)->goals_left.empty());
  CHECK(join.Receive(SampleGoals())->goals_left == std::vector<Cell>{{1, 2}});  // stands in (3,4)
  CHECK(GoalsJoin().Receive(bare) == bare);
}

TEST_CASE("A goal of the field is reached by a state, and stays so until newer goals say other",
          "[goals]") {
  RobotState state{.stamp = {100}, .robot = "r1", .grid = {5, 5, 1.0}, .cell = {2, 2}};
  state.position = {-1.0, 0.0};
  const Position near{0.9, 0.0};  // in cell (2, 3)
  const Position far{2.0, 2.0};   // in cell (0, 4)
  const RobotGoals goals{.stamp = {50}, .robot = "r1", .left = {near, far}, .total = 2};
  GoalsJoin join;
  CHECK_FALSE(join.Receive(goals));
  CHECK(join.Receive(state)->goals_left.size() == 2);
  state.stamp = {200};
  state.cell = {2, 3};
  CHECK(join.Receive(state)->goals_left == std::vector<Cell>{{0, 4}});
  CHECK(join.Receive(state)->goals_reached == std::vector<Cell>{{2, 3}});
  state.stamp = {300};
  state.cell = {1, 3};
  CHECK(join.Receive(state)->goals_left.size() == 1);
  // Sent before the state that reached it; then given again after it.
  RobotGoals next = goals;
  next.stamp = {150};
  CHECK(join.Receive(next)->goals_left.size() == 1);
  next.stamp = {200};
  CHECK(join.Receive(next)->goals_left.size() == 2);
  next.stamp = {250};
  next.tolerance_m = 1.0;
  state.position = {1.5, 0.0};
  CHECK(join.Receive(next)->goals_left.size() == 2);
  CHECK(join.Receive(state)->goals_left == std::vector<Cell>{{0, 4}});
  state.stamp = {10};  // a new run
  state.position = {-1.0, 0.0};
  CHECK(join.Receive(state)->goals_left.size() == 2);
}

TEST_CASE("Enumerators have the numbers of the IDL", "[convert]") {
  CHECK(static_cast<int>(CommandKind::kMove) ==
        conav_msgs::msg::RobotCommand_Constants::COMMAND_KIND_MOVE);
  CHECK(static_cast<int>(CommandKind::kTransmitView) ==
        conav_msgs::msg::RobotCommand_Constants::COMMAND_KIND_TRANSMIT_VIEW);
  CHECK(static_cast<int>(CommandKind::kDrive) ==
        conav_msgs::msg::RobotCommand_Constants::COMMAND_KIND_DRIVE);
  CHECK(static_cast<int>(DriveAction::kForward) ==
        conav_msgs::msg::RobotCommand_Constants::DRIVE_FORWARD);
  CHECK(static_cast<int>(DriveAction::kTurnRight) ==
        conav_msgs::msg::RobotCommand_Constants::DRIVE_TURN_RIGHT);
  CHECK(static_cast<int>(CommandOutcome::kDone) ==
        conav_msgs::msg::RobotState_Constants::COMMAND_OUTCOME_DONE);
  CHECK(static_cast<int>(CommandOutcome::kOccupied) ==
        conav_msgs::msg::RobotState_Constants::COMMAND_OUTCOME_OCCUPIED);
  CHECK(static_cast<int>(CommandOutcome::kExpired) ==
        conav_msgs::msg::RobotState_Constants::COMMAND_OUTCOME_EXPIRED);
}

TEST_CASE("A malformed command is refused", "[convert]") {
  CheckRefused(
      SampleCommand(),
      {
          {"robot", [](Command& m) { m.robot(""); }},
          {"robot", [](Command& m) { m.robot("r/1"); }},
          {"robot", [](Command& m) { m.robot(std::string(65, 'r')); }},
          {"kind", [](Command& m) { m.kind(4); }},
          {"drive", [](Command& m) { m.drive(5); }},
          {"heading", [](Command& m) { m.heading(std::nan("")); }},
          {"heading", [](Command& m) { m.heading(7.0); }},
          {"path is empty",
           [](Command& m) {
             m.kind(conav_msgs::msg::RobotCommand_Constants::COMMAND_KIND_MOVE);
             m.path().clear();
           }},
          {"path[1].position.x", [](Command& m) { m.path()[1].position().x(2.0e6); }},
          {"path.back().orientation", [](Command& m) { m.path()[1].orientation().w(0.9); }},
          {"tolerance", [](Command& m) { m.tolerance(-0.1); }},
          {"expires_at.sec", [](Command& m) { m.expires_at().sec(-2); }},
          {"header.stamp.sec", [](Command& m) { m.header().stamp().sec(-2); }},
      });
}

TEST_CASE("A malformed robot state is refused", "[convert]") {
  CheckRefused(
      SampleState(),
      {
          {"world", [](State& m) { m.world("w 1"); }},
          {"path[1]", [](State& m) { m.path()[1].x(10.5); }},
          {"path", [](State& m) { m.path().resize(65537); }},
          {"pose.position",
           [](State& m) {
             m.path().clear();
             m.pose().position().y(12.5);
           }},
          {"pose.orientation", [](State& m) { m.pose().orientation().z(INFINITY); }},
          {"pose.position.y", [](State& m) { m.pose().position().y(NAN); }},
          {"velocity.linear.x", [](State& m) { m.velocity().linear().x(NAN); }},
          {"distance", [](State& m) { m.distance(-1.0); }},
          {"map_info.resolution", [](State& m) { m.map_info().resolution(0.0F); }},
          {"map_info.origin.position.x", [](State& m) { m.map_info().origin().position().x(NAN); }},
          {"rows", [](State& m) { m.map_info().height(0); }},
          {"command_outcome", [](State& m) { m.command_outcome(8); }},
          {"command_detail", [](State& m) { m.command_detail(std::string(4097, 'x')); }},
          {"map_info.map_load_time.nanosec",
           [](State& m) { m.map_info().map_load_time().nanosec(2'000'000'000); }},
      });
}

TEST_CASE("Malformed goals are refused", "[convert]") {
  CheckRefused(SampleGoals(),
               {
                   {"robot", [](Goals& m) { m.robot("r 2"); }},
                   {"left[1].position.y", [](Goals& m) { m.left()[1].position().y(NAN); }},
                   {"reached[0].position.x", [](Goals& m) { m.reached()[0].position().x(-2.0e6); }},
                   {"total", [](Goals& m) { m.total(2); }},
                   {"tolerance", [](Goals& m) { m.tolerance(NAN); }},
               });
}

TEST_CASE("A malformed picture is refused", "[convert]") {
  CheckRefused(
      SampleSnapshot(),
      {
          {"sequence_number", [](SnapshotMessage& m) { m.sequence_number(0); }},
          {"horizontal_field_of_view",
           [](SnapshotMessage& m) { m.horizontal_field_of_view(-0.1); }},
          {"width", [](SnapshotMessage& m) { m.width(16385); }},
          {"format", [](SnapshotMessage& m) { m.format("png"); }},
          {"data", [](SnapshotMessage& m) { m.format("none"); }},
          {"data", [](SnapshotMessage& m) { m.data().clear(); }},
          {"data", [](SnapshotMessage& m) { m.data().resize((16U << 20) + 1); }},
          // The faults report's S13: "8 MiB junk snapshots x 12: operator RSS 26 -> 133 MB and it
          // stays; junk is not decoded, yet kept."
          {"data", [](SnapshotMessage& m) { m.data().resize(8U << 20); }},
          {"data",
           [](SnapshotMessage& m) {
             m.data() = {'j', 'u', 'n', 'k'};
           }},
          {"view.data[0]", [](SnapshotMessage& m) { m.view().data()[0] = 50; }},
          {"view.data", [](SnapshotMessage& m) { m.view().data().pop_back(); }},
          {"view.info.resolution", [](SnapshotMessage& m) { m.view().info().resolution(1.0F); }},
          {"view[0]", [](SnapshotMessage& m) { m.view().info().origin().position().x(-12.0); }},
          {"goals_left", [](SnapshotMessage& m) { m.goals_left()[0].y(50.0); }},
      });
}

}  // namespace
}  // namespace conav
