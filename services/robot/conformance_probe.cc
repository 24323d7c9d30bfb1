#include "robot/conformance_probe.h"

#include <fmt/core.h>

#include <algorithm>

namespace conav::robot {
namespace {

using namespace std::chrono_literals;

constexpr int kSlow = 20;            // times the patience
constexpr auto kInForce = 60s;       // of an ordinary command
constexpr double kStandsMps = 0.05;  // slower than this it stands
constexpr double kStandsRps = 0.05;
constexpr double kLeastStepM = 0.5;

}  // namespace

std::string_view OutcomeName(CommandOutcome outcome) {
  constexpr std::string_view kNames[] = {"none",     "running", "done",    "blocked",
                                         "occupied", "refused", "expired", "stopped"};
  return kNames[static_cast<std::size_t>(outcome)];
}

bool Probe::InTime(const std::function<bool()>& done) {
  return robot_.WaitUntil(done, options_.patience * kSlow);
}

bool Probe::Shows(const RobotCommand& command, CommandOutcome outcome) const {
  return state().lease_epoch == command.lease_epoch &&
         state().command_sequence_number == command.sequence_number &&
         state().command_outcome == outcome;
}

bool Probe::Stands() const {
  return std::abs(state().speed_mps) < kStandsMps && std::abs(state().yaw_rate_rps) < kStandsRps;
}

double Probe::StepM() const {
  return options_.step_m > 0.0 ? options_.step_m : std::max(kLeastStepM, state().grid.cell_size_m);
}

RobotCommand Probe::Next(CommandKind kind) {
  return {.stamp = state().stamp,
          .robot = options_.robot,
          .sequence_number = ++sequence_number_,
          .lease_epoch = epoch_,
          .expires_at = state().stamp + kInForce,
          .kind = kind};
}

RobotCommand Probe::Drive(Position to) {
  RobotCommand command = Next(CommandKind::kMove);
  command.path = {to};
  command.tolerance_m = std::max(0.1, 0.3 * state().grid.cell_size_m);
  return command;
}

bool Probe::IsFree(Position from, Position to) const {
  const MapUpdate& map = *robot_.report().map;
  const double length = Distance(from, to);
  const int samples = 1 + static_cast<int>(std::ceil(2.0 * length / map.cell_size_m));
  for (int i = 0; i <= samples; ++i) {
    const double share = static_cast<double>(i) / samples;
    const Cell cell = state().grid.PositionToCell(
        {from.x_m + share * (to.x_m - from.x_m), from.y_m + share * (to.y_m - from.y_m)});
    if (!map.cells.Contains(cell) || map.cells[cell] != Occupancy::kFree) return false;
  }
  return true;
}

std::optional<Position> Probe::FreePlace() const {
  // From the middle of its cell, since robots in mazes drive from middle to middle.
  const Position from = state().grid.CellToPosition(state().grid.PositionToCell(state().position));
  const double step = StepM();
  for (int i = 0; i < 4; ++i) {
    const double heading = HeadingFromIndex(i, 4);
    const Position to{from.x_m + step * std::cos(heading), from.y_m + step * std::sin(heading)};
    if (IsFree(from, to)) return to;
  }
  return std::nullopt;
}

std::optional<Position> Probe::Obstacle() const {
  const OccupancyGrid& map = robot_.report().map->cells;
  std::optional<Position> nearest;
  for (std::size_t i = 0; i < map.size(); ++i) {
    if (map.values()[i] != Occupancy::kOccupied) continue;
    const Position place = state().grid.CellToPosition(map.CellAt(i));
    if (!nearest || Distance(place, state().position) < Distance(*nearest, state().position)) {
      nearest = place;
    }
  }
  return nearest;
}

std::string Probe::Expect(const RobotCommand& command, CommandOutcome outcome) {
  robot_.Send(command);
  if (InTime([&] { return Shows(command, outcome); })) return "";
  if (state().command_sequence_number != command.sequence_number) {
    return fmt::format("it did not take up command {} of epoch {}", command.sequence_number,
                       command.lease_epoch);
  }
  return fmt::format("the outcome is {} and not {} {}", OutcomeName(state().command_outcome),
                     OutcomeName(outcome), state().command_detail);
}

std::string Probe::Stays(Position from, double allowance_m) {
  if (!Soon([&] { return Stands(); })) {
    return fmt::format("it drives on at {:.2f} m/s", state().speed_mps);
  }
  if (const double way = Distance(from, state().position); way > allowance_m) {
    return fmt::format("it drove {:.2f} m more", way);
  }
  const Position place = state().position;
  const auto moved = [&] { return Distance(place, state().position) > kDriftM; };
  return Happens(moved) ? "it moves without a command" : "";
}

std::string Probe::ExpectIgnored(const RobotCommand& command, bool malformed) {
  const RobotState before = state();
  malformed ? robot_.SendMalformed(command) : robot_.Send(command);
  const auto changed = [&] {
    return state().command_sequence_number != before.command_sequence_number ||
           state().lease_epoch != before.lease_epoch ||
           state().command_outcome != before.command_outcome ||
           Distance(state().position, before.position) > kDriftM;
  };
  if (!Happens(changed)) return "";
  return fmt::format("it took up command {} of epoch {}", state().command_sequence_number,
                     state().lease_epoch);
}

void Probe::SendStop(std::uint64_t revision, bool stopped) {
  robot_.Send(StopOrder{.stamp = state().stamp,
                        .world = state().world,
                        .robot = options_.robot,
                        .revision = revision,
                        .stopped = stopped,
                        .given_by = "conav-doctor",
                        .reason = stopped ? "a check" : ""});
}

}  // namespace conav::robot
