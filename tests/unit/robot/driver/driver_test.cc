#include "robot/driver/driver.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <memory>

namespace conav::robot {
namespace {

using namespace std::chrono_literals;

constexpr GridGeometry kGrid{5, 8, 1.0};

/// A driver with a body that does what its pursuit tells it, 0.05 s a step.
struct Rig {
  explicit Rig(DriverOptions options = {}, bool has_pan = false) {
    options.world = "w1";
    options.robot = "r1";
    options.picture_settle_s = 0.2;
    driver.emplace(
        options,
        std::make_unique<PursuitMover>(
            PursuitOptions{.speed_mps = 1.0, .turn_rps = 2.0},
            [this](const Velocity& asked) { velocity = asked; }, [this] { return mover_problem; }),
        has_pan ? Driver::Pan([this](double angle_rad) { pan_rad = angle_rad; }) : nullptr);
  }
  /// All that it needs, in a hall whose eastern column is a wall.
  void Equip() {
    driver->SetGrid(kGrid);
    SendMap();
    driver->Receive(CameraLens{});
    Step();
  }
  void SendMap() {
    RobotMap map{0.1, {{-4.0, -2.5}, 0.0}, 80, 50, {}};
    for (int i = 0; i < 80 * 50; ++i) map.data.push_back(i % 80 < 70 ? 0 : 100);
    driver->Receive(std::move(map), wall);
  }
  void Step() {
    wall += 50ms;
    now = now + 50ms;
    if (!is_stuck) {
      at = at * Pose{{velocity.forward_mps * 0.05, 0.0}, velocity.turn_rps * 0.05};
    }
    driver->Locate(at, problem, velocity.forward_mps, velocity.turn_rps);
    driver->Step(now, wall);
  }
  void StepFor(std::chrono::milliseconds time) {
    for (auto t = 0ms; t < time; t += 50ms) Step();
  }
  RobotCommand Command(CommandKind kind) {
    return {.robot = "r1",
            .sequence_number = ++number,
            .lease_epoch = 1,
            .expires_at = now + 20s,
            .kind = kind,
            .tolerance_m = 0.3};
  }
  RobotCommand MoveTo(Position place) {
    RobotCommand command = Command(CommandKind::kMove);
    command.path = {place};
    return command;
  }
  RobotState state() const { return driver->state().value(); }
  CommandOutcome Ends() {
    for (int i = 0; i < 1000 && driver->active(); ++i) Step();
    return state().command_outcome;
  }

  std::optional<Driver> driver;
  Pose at{kGrid.CellToPosition({2, 1}), 0.0};
  Velocity velocity;
  std::string problem;
  std::string mover_problem;
  bool is_stuck = false;
  double pan_rad = 0.0;
  Clock::TimePoint wall{};
  SimTime now{1};
  std::uint64_t number = 0;
};

TEST_CASE(
    "without plan, place or map a driver reports nothing and refuses commands with the reason",
    "[robot][driver]") {
  Rig rig;
  rig.Step();
  CHECK_FALSE(rig.driver->state());
  CHECK_THAT(rig.driver->Problem(), Catch::Contains("/w1/initial_map"));
  CHECK(rig.driver->Receive(rig.MoveTo(kGrid.CellToPosition({2, 2})), rig.now));
  CHECK_FALSE(rig.driver->active());
  rig.driver->SetGrid(kGrid);
  rig.Step();
  CHECK_FALSE(rig.driver->state());
  CHECK_THAT(rig.driver->Problem(), Catch::Contains("map: none"));
  rig.Equip();
  REQUIRE(rig.driver->state());
  CHECK(rig.state().grid == kGrid);
  CHECK(rig.state().cell == Cell{2, 1});
  CHECK(rig.driver->Problem().empty());
}

TEST_CASE("a move ends done in its place, with its cell on the path", "[robot][driver]") {
  Rig rig;
  rig.Equip();
  CHECK(rig.driver->TakeMap());
  const Position place = kGrid.CellToPosition({1, 1});
  REQUIRE(rig.driver->Receive(rig.MoveTo(place), rig.now));
  CHECK(rig.state().command_outcome == CommandOutcome::kRunning);
  CHECK(rig.Ends() == CommandOutcome::kDone);
  CHECK(Distance(rig.at.position, place) < 0.3);
  CHECK(rig.state().path == std::vector<Cell>{{2, 1}, {1, 1}});
  CHECK(rig.state().cell_moves == 1);
  CHECK(rig.state().distance_m == Approx(1.0).margin(0.3));
}

TEST_CASE(
    "what is missing makes the robot stand and say so, and the command goes on when it is back",
    "[robot][driver]") {
  Rig rig;
  rig.Equip();
  const std::string which = GENERATE("place", "map", "mover");
  CAPTURE(which);
  REQUIRE(rig.driver->Receive(rig.MoveTo(kGrid.CellToPosition({2, 4})), rig.now));
  rig.StepFor(1s);
  CHECK(rig.velocity.forward_mps > 0.5);
  if (which == "place") rig.problem = "localisation: odometry silent";
  if (which == "mover") rig.mover_problem = "mover: nobody listens";
  if (which == "map") rig.wall += 20s;
  rig.Step();
  CHECK(rig.velocity == Velocity{});
  CHECK_THAT(rig.state().command_detail, Catch::Contains(which == "place" ? "odometry" : which));
  CHECK(rig.state().command_outcome == CommandOutcome::kRunning);
  rig.StepFor(1s);
  CHECK(rig.velocity == Velocity{});
  rig.problem.clear();
  rig.mover_problem.clear();
  rig.SendMap();
  CHECK(rig.Ends() == CommandOutcome::kDone);
  CHECK(rig.state().command_detail.empty());
}

TEST_CASE("a command whose robot stands for too long expires with the reason", "[robot][driver]") {
  Rig rig;
  rig.Equip();
  rig.problem = "localisation: odometry silent";
  REQUIRE(rig.driver->Receive(rig.MoveTo(kGrid.CellToPosition({2, 4})), rig.now));
  CHECK(rig.Ends() == CommandOutcome::kExpired);
  CHECK_THAT(rig.state().command_detail, Catch::Contains("odometry silent"));
  CHECK(rig.velocity == Velocity{});
}

TEST_CASE("a robot that was somewhere else when its place came back drives no old command",
          "[robot][driver]") {
  Rig rig;
  rig.Equip();
  REQUIRE(rig.driver->Receive(rig.MoveTo(kGrid.CellToPosition({2, 4})), rig.now));
  rig.StepFor(500ms);
  rig.problem = "localisation: jumped by 2.0 m";
  rig.Step();
  rig.at.position.y_m += 2.0;
  rig.Step();
  rig.problem.clear();
  CHECK(rig.Ends() == CommandOutcome::kRefused);
  CHECK_THAT(rig.state().command_detail, Catch::Contains("2.0 m"));
}

TEST_CASE("a wall ends a move as blocked before the robot starts, and so does one that turns up",
          "[robot][driver]") {
  Rig rig;
  rig.Equip();
  REQUIRE(rig.driver->Receive(rig.MoveTo(kGrid.CellToPosition({2, 7})), rig.now));
  CHECK(rig.state().command_outcome == CommandOutcome::kBlocked);
  CHECK(rig.state().command_cell == Cell{2, 7});
  REQUIRE(rig.driver->Receive(rig.MoveTo(kGrid.CellToPosition({2, 5})), rig.now));
  rig.StepFor(500ms);
  RobotMap map{0.1, {{-1.0, -2.5}, 0.0}, 10, 50, std::vector<std::int8_t>(500, 100)};
  rig.driver->Receive(std::move(map), rig.wall);
  CHECK(rig.Ends() == CommandOutcome::kBlocked);
  CHECK(rig.state().command_cell == Cell{2, 3});
  CHECK(rig.velocity == Velocity{});
  REQUIRE(rig.driver->TakeMap());
}

TEST_CASE("a robot that does not get on calls the way blocked, and tries it again later",
          "[robot][driver]") {
  Rig rig({.stuck_s = 3.0, .blocked_for_s = 10.0});
  rig.Equip();
  rig.is_stuck = true;
  REQUIRE(rig.driver->Receive(rig.MoveTo(kGrid.CellToPosition({2, 2})), rig.now));
  CHECK(rig.Ends() == CommandOutcome::kBlocked);
  CHECK(rig.state().command_cell == Cell{2, 2});
  rig.StepFor(100ms);
  auto map = rig.driver->TakeMap();
  REQUIRE(map);
  CHECK(map->cells[{2, 2}] == Occupancy::kOccupied);
  CHECK(rig.state().map_stamp == map->stamp);
  rig.StepFor(12s);
  map = rig.driver->TakeMap();
  REQUIRE(map);
  CHECK(map->cells[{2, 2}] == Occupancy::kFree);
}

TEST_CASE(
    "a robot waits for another one on its way, claims no place meanwhile, and gives up in the end",
    "[robot][driver]") {
  Rig rig;
  rig.Equip();
  rig.driver->SetHeldByOthers({kGrid.CellToPosition({2, 3})});
  REQUIRE(rig.driver->Receive(rig.MoveTo(kGrid.CellToPosition({2, 4})), rig.now));
  rig.StepFor(1s);
  CHECK(rig.velocity == Velocity{});
  CHECK(rig.state().command_outcome == CommandOutcome::kRunning);
  CHECK_THAT(rig.state().command_detail, Catch::Contains("another robot"));
  CHECK(rig.state().command_cell == rig.state().cell);
  if (GENERATE(true, false)) {
    rig.driver->SetHeldByOthers({});
    CHECK(rig.Ends() == CommandOutcome::kDone);
    CHECK(rig.state().cell == Cell{2, 4});
    CHECK(rig.state().command_cell == Cell{2, 4});
    return;
  }
  CHECK(rig.Ends() == CommandOutcome::kOccupied);
  CHECK(rig.state().command_cell == Cell{2, 4});
  CHECK(rig.driver->Receive(rig.MoveTo(kGrid.CellToPosition({1, 1})), rig.now));
  CHECK(rig.Ends() == CommandOutcome::kDone);
}

TEST_CASE("a stop and a newer command brake at once", "[robot][driver]") {
  Rig rig;
  rig.Equip();
  REQUIRE(rig.driver->Receive(rig.MoveTo(kGrid.CellToPosition({2, 4})), rig.now));
  rig.StepFor(1s);
  rig.driver->Receive(StopOrder{{}, "w1", "r1", 1, true, "anna", ""});
  CHECK(rig.velocity == Velocity{});
  CHECK(rig.state().stopped);
  CHECK(rig.state().command_outcome == CommandOutcome::kStopped);
  rig.driver->Receive(StopOrder{{}, "w1", "r1", 2, false, "anna", ""});
  REQUIRE(rig.driver->Receive(rig.MoveTo(kGrid.CellToPosition({2, 4})), rig.now));
  rig.StepFor(1s);
  REQUIRE(rig.driver->Receive(rig.Command(CommandKind::kStop), rig.now));
  CHECK(rig.velocity == Velocity{});
  CHECK(rig.state().command_outcome == CommandOutcome::kDone);
  auto old = rig.Command(CommandKind::kStop);
  old.sequence_number = 1;
  CHECK_FALSE(rig.driver->Receive(old, rig.now));
}

TEST_CASE(
    "a view turns the robot, or the camera's joint as far as it goes, and takes a picture after",
    "[robot][driver]") {
  const bool has_pan = GENERATE(false, true);
  CAPTURE(has_pan);
  Rig rig({.pan_least_rad = -1.0, .pan_most_rad = 1.0, .pan_settle_s = 0.5}, has_pan);
  rig.Equip();
  RobotCommand view = rig.Command(CommandKind::kTransmitView);
  view.heading_rad = 1.5;
  REQUIRE(rig.driver->Receive(view, rig.now));
  for (int i = 0; i < 200 && !rig.driver->picture_wanted_since(); ++i) rig.Step();
  REQUIRE(rig.driver->picture_wanted_since());
  CHECK(*rig.driver->picture_wanted_since() - rig.wall > (has_pan ? 400ms : 100ms));
  CHECK(rig.at.heading_rad == Approx(has_pan ? 0.5 : 1.5).margin(0.06));
  CHECK(rig.pan_rad == (has_pan ? 1.0 : 0.0));
  rig.driver->Receive(Picture{4, 3, {1, 2, 3}}, {}, rig.now);
  CHECK(rig.state().command_outcome == CommandOutcome::kDone);
  const auto snapshot = rig.driver->TakeSnapshot();
  REQUIRE(snapshot);
  CHECK(snapshot->sequence_number == 1);
  CHECK(snapshot->heading_rad == Approx(1.5).margin(0.06));
  CHECK(Contains(snapshot->visible.free, Cell{1, 1}));
  CHECK(rig.state().snapshots == 1);
  CHECK(rig.state().path.size() == 1);
}

TEST_CASE("a camera that is silent ends a view as refused", "[robot][driver]") {
  Rig rig({.picture_timeout_s = 1.0});
  rig.Equip();
  REQUIRE(rig.driver->Receive(rig.Command(CommandKind::kTransmitView), rig.now));
  CHECK(rig.Ends() == CommandOutcome::kRefused);
  CHECK_THAT(rig.state().command_detail, Catch::Contains("camera"));
}

TEST_CASE("a drive step lasts a quarter of a second, and none leads into a wall",
          "[robot][driver]") {
  Rig rig;
  rig.Equip();
  RobotCommand drive = rig.Command(CommandKind::kDrive);
  drive.drive = DriveAction::kForward;
  REQUIRE(rig.driver->Receive(drive, rig.now));
  CHECK(rig.Ends() == CommandOutcome::kDone);
  CHECK(rig.velocity == Velocity{});
  CHECK(rig.state().low_level_steps == 1);
  CHECK(rig.state().distance_m == Approx(0.25).margin(0.1));
  rig.at.position = {2.7, 0.0};  // in front of the wall at x = 3
  rig.Step();
  drive = rig.Command(CommandKind::kDrive);
  drive.drive = DriveAction::kForward;
  REQUIRE(rig.driver->Receive(drive, rig.now));
  CHECK(rig.Ends() == CommandOutcome::kBlocked);
}

TEST_CASE("a place outside of the plan is a reason to stand", "[robot][driver]") {
  Rig rig;
  rig.Equip();
  rig.at.position = {50.0, 0.0};
  rig.Step();
  CHECK_THAT(rig.driver->Problem(), Catch::Contains("outside of the plan"));
  CHECK(rig.state().position.x_m < 5.0);  // the last one on it
}

TEST_CASE(
    "the robot's time follows the time of day, whose steps end no command and prolong none for "
    "long",
    "[driver]") {
  const auto after = [](double day_s, std::chrono::nanoseconds elapsed) {
    return FollowTimeOfDay(SimTime::FromSeconds(100.0), SimTime::FromSeconds(day_s), elapsed)
        .ToSeconds();
  };
  CHECK(after(100.25, 250ms) == 100.25);
  CHECK(after(98.25, 250ms) == 100.125);                   // set back by 2 s
  CHECK(after(102.25, 250ms) == 100.5);                    // set ahead by 2 s
  CHECK(after(1e9, 250ms) == Approx(1e9).epsilon(1e-12));  // no clock before
  CHECK(after(100.0, 0ms) == 100.0);
}

}  // namespace
}  // namespace conav::robot
