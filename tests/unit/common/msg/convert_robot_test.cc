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
using Snapshot = conav_msgs::msg::Snapshot;

TEST_CASE("Robot commands, states and pictures survive the wire", "[protocol][convert]") {
  CheckRoundTrip(SampleCommand());
  CheckRoundTrip(SampleState());
  CheckRoundTrip(SampleSnapshot());
}

TEST_CASE("Enumerators have the numbers of the IDL", "[protocol][convert]") {
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

TEST_CASE("A picture without a camera has format none", "[protocol][convert]") {
  Snapshot picture = SampleSnapshot();
  picture.jpeg.clear();
  CHECK(ToMessage(picture).format() == "none");
  CheckRoundTrip(picture);
}

TEST_CASE("A malformed command is refused", "[protocol][convert]") {
  CheckRefused(
      SampleCommand(), [](Command& m) { m.robot(""); }, "robot is empty");
  CheckRefused(
      SampleCommand(), [](Command& m) { m.robot("r/1"); },
      "robot = 'r/1' has a character outside of [A-Za-z0-9_]");
  CheckRefused(
      SampleCommand(), [](Command& m) { m.robot(std::string(65, 'r')); },
      "robot has size 65, more than 64");
  CheckRefused(
      SampleCommand(), [](Command& m) { m.kind(4); }, "kind = 4 is not in [0, 3]");
  CheckRefused(
      SampleCommand(), [](Command& m) { m.drive(5); }, "drive = 5 is not in [0, 4]");
  CheckRefused(
      SampleCommand(), [](Command& m) { m.heading(std::nan("")); }, "heading = nan is not finite");
  CheckRefused(
      SampleCommand(), [](Command& m) { m.heading(7.0); },
      "heading = 7 is not in [-6.283185307179586, 6.283185307179586]");
  CheckRefused(
      SampleCommand(), [](Command& m) { m.target().row(-1); },
      "target = (-1,5) is outside of 1024 x 1024 cells");
  CheckRefused(
      SampleCommand(), [](Command& m) { m.expires_at().sec(-2); },
      "expires_at.sec = -2 is below 0");
  CheckRefused(
      SampleCommand(), [](Command& m) { m.header().stamp().sec(-2); },
      "header.stamp.sec = -2 is below 0");
}

TEST_CASE("A malformed robot state is refused", "[protocol][convert]") {
  CheckRefused(
      SampleState(), [](State& m) { m.world("w 1"); },
      "world = 'w 1' has a character outside of [A-Za-z0-9_]");
  CheckRefused(
      SampleState(), [](State& m) { m.cell().column(1024); },
      "cell = (3,1024) is outside of 1024 x 1024 cells");
  CheckRefused(
      SampleState(), [](State& m) { m.heading(INFINITY); }, "heading = inf is not finite");
  CheckRefused(
      SampleState(), [](State& m) { m.position().y(NAN); }, "position.y = nan is not finite");
  CheckRefused(
      SampleState(), [](State& m) { m.goals_left()[1].row(-4); },
      "goals_left[1] = (-4,4) is outside of 1024 x 1024 cells");
  CheckRefused(
      SampleState(), [](State& m) { m.goals_reached()[0].row(2000); },
      "goals_reached[0] = (2000,8) is outside of 1024 x 1024 cells");
  CheckRefused(
      SampleState(), [](State& m) { m.goals_total(2); },
      "goals_total = 2 is below goals_left + goals_reached = 3");
  CheckRefused(
      SampleState(), [](State& m) { m.path().resize(65537); },
      "path has size 65537, more than 65536");
  CheckRefused(
      SampleState(), [](State& m) { m.command_outcome(7); },
      "command_outcome = 7 is not in [0, 6]");
  CheckRefused(
      SampleState(), [](State& m) { m.command_detail(std::string(4097, 'x')); },
      "command_detail has size 4097, more than 4096");
  CheckRefused(
      SampleState(), [](State& m) { m.map_stamp().nanosec(2'000'000'000); },
      "map_stamp.nanosec = 2000000000 is not below 1000000000");
}

TEST_CASE("A malformed picture is refused", "[protocol][convert]") {
  CheckRefused(
      SampleSnapshot(), [](Snapshot& m) { m.sequence_number(0); },
      "sequence_number = 0 is below 1");
  CheckRefused(
      SampleSnapshot(), [](Snapshot& m) { m.horizontal_field_of_view(-0.1); },
      "horizontal_field_of_view = -0.1 is not in [0, 6.283185307179586]");
  CheckRefused(
      SampleSnapshot(), [](Snapshot& m) { m.width(16385); }, "width = 16385 is not in [0, 16384]");
  CheckRefused(
      SampleSnapshot(), [](Snapshot& m) { m.format("png"); },
      "format = 'png' is not 'jpeg' or 'none'");
  CheckRefused(
      SampleSnapshot(), [](Snapshot& m) { m.format("none"); }, "data has size 3 in format 'none'");
  CheckRefused(
      SampleSnapshot(), [](Snapshot& m) { m.data().clear(); }, "data is empty in format 'jpeg'");
  CheckRefused(
      SampleSnapshot(), [](Snapshot& m) { m.data().resize((16U << 20) + 1); },
      "data has size 16777217, more than 16777216");
  CheckRefused(
      SampleSnapshot(), [](Snapshot& m) { m.wall_cells()[0].column(-1); },
      "wall_cells[0] = (1,-1) is outside of 1024 x 1024 cells");
  CheckRefused(
      SampleSnapshot(), [](Snapshot& m) { m.wall_cells(m.free_cells()); },
      "free_cells holds (2,2), which wall_cells holds too");
}

TEST_CASE("Visible cells are sorted on arrival", "[protocol][convert]") {
  Snapshot message = ToMessage(SampleSnapshot());
  std::swap(message.free_cells()[0], message.free_cells()[1]);
  message.free_cells().push_back(message.free_cells()[0]);
  const auto picture = ToDomain(message);
  REQUIRE(picture);
  CHECK(picture->visible == SampleSnapshot().visible);
}

}  // namespace
}  // namespace conav
