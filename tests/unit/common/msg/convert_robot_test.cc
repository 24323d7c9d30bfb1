#include <cmath>

#include "unit/common/msg/convert_expectations.h"
#include "unit/common/msg/samples.h"

namespace conav {
namespace {

using samples::SampleCommand;
using samples::SampleSnapshot;
using samples::SampleState;
using Command = conav_msgs::msg::RobotCommand;
using State = conav_msgs::msg::RobotState;
using SnapshotMessage = conav_msgs::msg::Snapshot;

TEST_CASE("Robot commands, states and snapshots survive the wire", "[convert]") {
  Snapshot without_camera = SampleSnapshot();
  without_camera.jpeg.clear();
  CHECK(ToMessage(without_camera).format() == "none");
  CheckRoundTrips(SampleCommand(), SampleState(), SampleSnapshot(), without_camera);
}

TEST_CASE("Enumerators have the numbers of the IDL", "[convert]") {
  CHECK(static_cast<int>(CommandKind::kMove) == conav_msgs::msg::COMMAND_KIND_MOVE);
  CHECK(static_cast<int>(CommandKind::kTransmitView) ==
        conav_msgs::msg::COMMAND_KIND_TRANSMIT_VIEW);
  CHECK(static_cast<int>(CommandKind::kDrive) == conav_msgs::msg::COMMAND_KIND_DRIVE);
  CHECK(static_cast<int>(DriveAction::kForward) == conav_msgs::msg::DRIVE_FORWARD);
  CHECK(static_cast<int>(DriveAction::kTurnRight) == conav_msgs::msg::DRIVE_TURN_RIGHT);
  CHECK(static_cast<int>(CommandOutcome::kDone) == conav_msgs::msg::COMMAND_OUTCOME_DONE);
  CHECK(static_cast<int>(CommandOutcome::kOccupied) == conav_msgs::msg::COMMAND_OUTCOME_OCCUPIED);
  CHECK(static_cast<int>(CommandOutcome::kExpired) == conav_msgs::msg::COMMAND_OUTCOME_EXPIRED);
}

TEST_CASE("A malformed command is refused", "[convert]") {
  CheckRefused(SampleCommand(),
               {
                   {"robot", [](Command& m) { m.robot(""); }},
                   {"robot", [](Command& m) { m.robot("r/1"); }},
                   {"robot", [](Command& m) { m.robot(std::string(65, 'r')); }},
                   {"kind", [](Command& m) { m.kind(4); }},
                   {"drive", [](Command& m) { m.drive(5); }},
                   {"heading", [](Command& m) { m.heading(std::nan("")); }},
                   {"heading", [](Command& m) { m.heading(7.0); }},
                   {"target", [](Command& m) { m.target().row(-1); }},
                   {"expires_at.sec", [](Command& m) { m.expires_at().sec(-2); }},
                   {"header.stamp.sec", [](Command& m) { m.header().stamp().sec(-2); }},
               });
}

TEST_CASE("A malformed robot state is refused", "[convert]") {
  CheckRefused(SampleState(),
               {
                   {"world", [](State& m) { m.world("w 1"); }},
                   {"cell", [](State& m) { m.cell().column(1024); }},
                   {"heading", [](State& m) { m.heading(INFINITY); }},
                   {"position.y", [](State& m) { m.position().y(NAN); }},
                   {"goals_left[1]", [](State& m) { m.goals_left()[1].row(-4); }},
                   {"goals_reached[0]", [](State& m) { m.goals_reached()[0].row(2000); }},
                   {"goals_total", [](State& m) { m.goals_total(2); }},
                   {"path", [](State& m) { m.path().resize(65537); }},
                   {"command_outcome", [](State& m) { m.command_outcome(7); }},
                   {"command_detail", [](State& m) { m.command_detail(std::string(4097, 'x')); }},
                   {"map_stamp.nanosec", [](State& m) { m.map_stamp().nanosec(2'000'000'000); }},
               });
}

TEST_CASE("A malformed picture is refused", "[convert]") {
  CheckRefused(SampleSnapshot(),
               {
                   {"sequence_number", [](SnapshotMessage& m) { m.sequence_number(0); }},
                   {"horizontal_field_of_view",
                    [](SnapshotMessage& m) { m.horizontal_field_of_view(-0.1); }},
                   {"width", [](SnapshotMessage& m) { m.width(16385); }},
                   {"format", [](SnapshotMessage& m) { m.format("png"); }},
                   {"data", [](SnapshotMessage& m) { m.format("none"); }},
                   {"data", [](SnapshotMessage& m) { m.data().clear(); }},
                   {"data", [](SnapshotMessage& m) { m.data().resize((16U << 20) + 1); }},
                   {"wall_cells[0]", [](SnapshotMessage& m) { m.wall_cells()[0].column(-1); }},
                   {"free_cells", [](SnapshotMessage& m) { m.wall_cells(m.free_cells()); }},
               });
}

TEST_CASE("Visible cells are sorted on arrival", "[convert]") {
  SnapshotMessage message = ToMessage(SampleSnapshot());
  std::swap(message.free_cells()[0], message.free_cells()[1]);
  message.free_cells().push_back(message.free_cells()[0]);
  const auto snapshot = ToDomain(message);
  REQUIRE(snapshot);
  CHECK(snapshot->visible == SampleSnapshot().visible);
}

}  // namespace
}  // namespace conav
