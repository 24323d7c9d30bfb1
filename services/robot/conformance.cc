#include "robot/conformance.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "robot/command_gate.h"

namespace conav::robot {
namespace {

using namespace std::chrono_literals;
using Verdict = ClauseResult::Verdict;

constexpr int kSlow = 20;            // times the patience
constexpr auto kInForce = 60s;       // of an ordinary command
constexpr double kStandsMps = 0.05;  // slower than this it stands
constexpr double kStandsRps = 0.05;
constexpr double kDriftM = 0.1;  // of a robot that stands
constexpr double kLeastStepM = 0.5;
constexpr double kHeadingTolerance = 0.1;  // rad
constexpr auto kStatePeriod = 500ms;       // of the robot's time

double Distance(Position a, Position b) { return std::hypot(a.x_m - b.x_m, a.y_m - b.y_m); }

std::string_view OutcomeName(CommandOutcome outcome) {
  constexpr std::string_view kNames[] = {"none",     "running", "done",    "blocked",
                                         "occupied", "refused", "expired", "stopped"};
  return kNames[static_cast<std::size_t>(outcome)];
}

/// The checks, in the order in which they are made; each leaves the robot standing, not stopped.
/// A check returns what it saw instead of what the clause promises; empty = the clause holds.
class Suite {
 public:
  Suite(RobotUnderTest& robot, const ConformanceOptions& options)
      : robot_(robot), options_(options) {}

  std::string Begins();
  std::string Map();
  std::string Camera();
  std::string Move();
  std::string StateRate();
  std::string Repeat();
  std::string OldSequence();
  std::string OldEpoch();
  std::string EpochFarAhead();
  std::string OfAnotherRobot();
  std::string Malformed();
  std::string ExpiredOnArrival();
  std::string ExpiredOnTheWay();
  std::string Replaced();
  std::string Blocked();
  std::string View();
  std::string Stop();
  std::string StoppedForEveryEpoch();
  std::string OldResume();
  std::string Resume();

 private:
  const RobotState& state() const { return *robot_.report().state; }
  RobotCommand Next(CommandKind kind);
  RobotCommand Drive(Position to);
  bool Soon(const std::function<bool()>& done) { return robot_.WaitUntil(done, options_.patience); }
  bool InTime(const std::function<bool()>& done) {
    return robot_.WaitUntil(done, options_.patience * kSlow);
  }
  bool Shows(const RobotCommand& command, CommandOutcome outcome) const {
    return state().lease_epoch == command.lease_epoch &&
           state().command_sequence_number == command.sequence_number &&
           state().command_outcome == outcome;
  }
  bool Stands() const {
    return std::abs(state().speed_mps) < kStandsMps && std::abs(state().yaw_rate_rps) < kStandsRps;
  }
  /// Sends the command and waits for that outcome; else says what came.
  std::string Expect(const RobotCommand& command, CommandOutcome outcome);
  /// Sends the command, which must change nothing.
  std::string ExpectIgnored(const RobotCommand& command, bool malformed = false);
  /// Waits until it stands, which it must do within `allowance_m` of `from`, and for a while longer.
  std::string Stays(Position from, double allowance_m = kDriftM);
  void SendStop(std::uint64_t revision, bool stopped);
  /// Where to drive from here: the free place of the map in one of the four directions; else
  /// nothing.
  std::optional<Position> FreePlace() const;
  std::optional<Position> Obstacle() const;
  bool IsFree(Position from, Position to) const;
  double StepM() const;
  /// How far it may roll on: it must not get where it was going.
  double Braking() const { return 0.45 * StepM(); }

  RobotUnderTest& robot_;
  const ConformanceOptions& options_;
  std::uint64_t epoch_ = 0;
  std::uint64_t sequence_number_ = 0;
  RobotCommand moved_;  // the first drive
  Position home_;
};

double Suite::StepM() const {
  return options_.step_m > 0.0 ? options_.step_m : std::max(kLeastStepM, state().grid.cell_size_m);
}

RobotCommand Suite::Next(CommandKind kind) {
  return {.stamp = state().stamp,
          .robot = options_.robot,
          .sequence_number = ++sequence_number_,
          .lease_epoch = epoch_,
          .expires_at = state().stamp + kInForce,
          .kind = kind};
}

RobotCommand Suite::Drive(Position to) {
  RobotCommand command = Next(CommandKind::kMove);
  command.path = {to};
  command.tolerance_m = std::max(0.1, 0.3 * state().grid.cell_size_m);
  return command;
}

bool Suite::IsFree(Position from, Position to) const {
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

std::optional<Position> Suite::FreePlace() const {
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

std::optional<Position> Suite::Obstacle() const {
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

std::string Suite::Expect(const RobotCommand& command, CommandOutcome outcome) {
  robot_.Send(command);
  if (InTime([&] { return Shows(command, outcome); })) return "";
  if (state().command_sequence_number != command.sequence_number) {
    return fmt::format("it did not take up command {} of epoch {}", command.sequence_number,
                       command.lease_epoch);
  }
  return fmt::format("the outcome is {} and not {} {}", OutcomeName(state().command_outcome),
                     OutcomeName(outcome), state().command_detail);
}

std::string Suite::Stays(Position from, double allowance_m) {
  if (!Soon([&] { return Stands(); })) {
    return fmt::format("it drives on at {:.2f} m/s", state().speed_mps);
  }
  if (const double way = Distance(from, state().position); way > allowance_m) {
    return fmt::format("it drove {:.2f} m more", way);
  }
  const Position place = state().position;
  const auto moved = [&] { return Distance(place, state().position) > kDriftM; };
  return robot_.WaitUntil(moved, options_.quiet) ? "it moves without a command" : "";
}

std::string Suite::ExpectIgnored(const RobotCommand& command, bool malformed) {
  const RobotState before = state();
  malformed ? robot_.SendMalformed(command) : robot_.Send(command);
  const auto changed = [&] {
    return state().command_sequence_number != before.command_sequence_number ||
           state().lease_epoch != before.lease_epoch ||
           state().command_outcome != before.command_outcome ||
           Distance(state().position, before.position) > kDriftM;
  };
  if (!robot_.WaitUntil(changed, options_.quiet)) return "";
  return fmt::format("it took up command {} of epoch {}", state().command_sequence_number,
                     state().lease_epoch);
}

std::string Suite::Begins() {
  if (!Soon([&] { return robot_.report().state.has_value(); })) return "no state came";
  if (state().stopped) return "it is stopped: resume it first";
  if (state().command_outcome == CommandOutcome::kRunning) {
    return "it carries out a command: end the planner that drives it first";
  }
  epoch_ = state().lease_epoch + 1;
  home_ = state().position;
  return "";
}

std::string Suite::Map() {
  const auto has_map = [&] {
    return robot_.report().map && robot_.report().map->stamp == state().map_stamp;
  };
  if (!Soon(has_map)) return "no map came whose stamp is map_info.map_load_time of the state";
  const MapUpdate& map = *robot_.report().map;
  const GridGeometry& grid = state().grid;
  if (map.cells.rows() != grid.rows || map.cells.columns() != grid.columns) {
    return fmt::format("map_info says {}x{}, the map has {}x{}", grid.rows, grid.columns,
                       map.cells.rows(), map.cells.columns());
  }
  const Cell here = grid.PositionToCell(state().position);
  if (!map.cells.Contains(here)) return "it stands outside of its map";
  return map.cells[here] == Occupancy::kFree ? "" : "the place where it stands is not free";
}

std::string Suite::Camera() {
  return Soon([&] { return robot_.report().lens.has_value(); }) ? "" : "no camera_info came";
}

std::string Suite::Move() {
  const auto place = FreePlace();
  if (!place) return fmt::format("its map has no free {} m around it to drive", StepM());
  const RobotState before = state();
  moved_ = Drive(*place);
  robot_.Send(moved_);
  if (!Soon([&] {
        return Shows(moved_, CommandOutcome::kRunning) || Shows(moved_, CommandOutcome::kDone);
      })) {
    return "it did not take the command up";
  }
  if (!InTime([&] { return Shows(moved_, CommandOutcome::kDone); })) {
    return fmt::format("the outcome is {} and not done {}", OutcomeName(state().command_outcome),
                       state().command_detail);
  }
  if (const double off = Distance(state().position, *place); off > moved_.tolerance_m) {
    return fmt::format("it is {:.2f} m away, the tolerance is {:.2f} m", off, moved_.tolerance_m);
  }
  if (state().distance_m < before.distance_m + Distance(before.position, state().position) / 2.0) {
    return "`distance` did not grow by the way driven";
  }
  return state().path.size() > before.path.size() ? "" : "`path` did not grow";
}

std::string Suite::StateRate() {
  const std::vector<RobotState>& states = robot_.report().states;
  for (std::size_t i = 1; i < states.size(); ++i) {
    if (states[i].stamp < states[i - 1].stamp) return "stamps go back";
    if (states[i].stamp <= states[i - 1].stamp + kStatePeriod) continue;
    return fmt::format("{:.2f} s of its time without a state, after {:.2f} s",
                       (states[i].stamp.ToSeconds() - states[i - 1].stamp.ToSeconds()),
                       states[i - 1].stamp.ToSeconds());
  }
  return states.size() > 1 ? "" : "one state only";
}

std::string Suite::Repeat() { return ExpectIgnored(moved_); }

std::string Suite::OldSequence() {
  RobotCommand old = Drive(home_);
  old.sequence_number = 0;
  return ExpectIgnored(old);
}

std::string Suite::OldEpoch() {
  RobotCommand old = Drive(home_);
  --old.lease_epoch;
  return ExpectIgnored(old);
}

std::string Suite::EpochFarAhead() {
  RobotCommand command = Drive(home_);
  command.lease_epoch = ~std::uint64_t{0};
  return ExpectIgnored(command);
}

std::string Suite::OfAnotherRobot() {
  RobotCommand command = Drive(home_);
  command.robot = options_.robot + "_";
  return ExpectIgnored(command);
}

std::string Suite::Malformed() { return ExpectIgnored(Drive(home_), true); }

std::string Suite::ExpiredOnArrival() {
  RobotCommand late = Drive(home_);
  late.expires_at = state().stamp;
  const Position before = state().position;
  if (auto why = Expect(late, CommandOutcome::kExpired); !why.empty()) return why;
  return Stays(before);
}

std::string Suite::ExpiredOnTheWay() {
  RobotCommand command = Drive(home_);
  command.expires_at = state().stamp + 500ms;
  if (auto why = Expect(command, CommandOutcome::kExpired); !why.empty()) return why;
  return Stays(state().position, Braking());
}

std::string Suite::Replaced() {
  const RobotCommand first = Drive(home_);
  robot_.Send(first);
  Soon([&] { return Shows(first, CommandOutcome::kRunning); });
  if (auto why = Expect(Next(CommandKind::kStop), CommandOutcome::kDone); !why.empty()) return why;
  if (auto why = Stays(state().position, Braking()); !why.empty()) return why;
  return Expect(Drive(home_), CommandOutcome::kDone);
}

std::string Suite::Blocked() {
  const auto place = Obstacle();
  if (!place) return "?its map has no obstacle";
  const Position before = state().position;
  const RobotCommand command = Drive(*place);
  robot_.Send(command);
  const bool ended = InTime([&] {
    return Shows(command, CommandOutcome::kBlocked) || Shows(command, CommandOutcome::kRefused);
  });
  if (!ended) return "a drive into an obstacle of its map did not end as blocked or refused";
  if (auto why = Stays(state().position, Braking()); !why.empty()) return why;
  const Cell here = state().grid.PositionToCell(state().position);
  if (robot_.report().map->cells[here] != Occupancy::kFree) return "it drove into the obstacle";
  return Distance(before, state().position) <= Distance(before, *place) ? "" : "it drove past it";
}

std::string Suite::View() {
  RobotCommand command = Next(CommandKind::kTransmitView);
  command.heading_rad = WrapAngle(state().heading_rad + std::numbers::pi / 2.0);
  const std::uint64_t number = state().snapshots + 1;
  if (auto why = Expect(command, CommandOutcome::kDone); !why.empty()) return why;
  const auto came = [&] {
    const auto& snapshot = robot_.report().snapshot;
    return snapshot && snapshot->sequence_number == number && !snapshot->streamed;
  };
  if (!Soon(came)) return fmt::format("no snapshot with sequence_number {} came", number);
  if (!Soon([&] { return state().snapshots == number; })) {
    return fmt::format("`snapshots` of the state is {} and not {}", state().snapshots, number);
  }
  const Snapshot& snapshot = *robot_.report().snapshot;
  if (std::abs(WrapAngle(snapshot.heading_rad - command.heading_rad)) > kHeadingTolerance) {
    return fmt::format("it looked towards {:.2f} rad and not {:.2f}", snapshot.heading_rad,
                       command.heading_rad);
  }
  if (snapshot.visible.free.empty() && snapshot.visible.walls.empty()) return "`view` is empty";
  return state().path.size() == 1 ? "" : "`path` did not begin again at the picture";
}

void Suite::SendStop(std::uint64_t revision, bool stopped) {
  robot_.Send(StopOrder{.stamp = state().stamp,
                        .world = state().world,
                        .robot = options_.robot,
                        .revision = revision,
                        .stopped = stopped,
                        .given_by = "conav-doctor",
                        .reason = stopped ? "a check" : ""});
}

std::string Suite::Stop() {
  const auto place = FreePlace();
  if (!place) return fmt::format("its map has no free {} m around it to drive", StepM());
  const RobotCommand command = Drive(*place);
  robot_.Send(command);
  Soon([&] { return Shows(command, CommandOutcome::kRunning); });
  const std::uint64_t revision = state().stop_revision + 1;
  SendStop(revision, true);
  if (!Soon([&] { return state().stopped && state().stop_revision == revision; })) {
    return "its state does not confirm the stop (`stopped`, `stop_revision`)";
  }
  if (state().command_outcome == CommandOutcome::kDone) {
    return "?it had arrived before the stop: let its simulator run at speed 1, or give --step";
  }
  if (state().command_outcome != CommandOutcome::kStopped) {
    return fmt::format("the command in force ended as {} and not stopped",
                       OutcomeName(state().command_outcome));
  }
  return Stays(state().position, Braking());
}

std::string Suite::StoppedForEveryEpoch() {
  for (int i = 0; i < 2; ++i) {
    const Position before = state().position;
    const RobotCommand command = Drive(FreePlace().value_or(home_));
    if (auto why = Expect(command, CommandOutcome::kStopped); !why.empty()) return why;
    if (auto why = Stays(before); !why.empty()) return why;
    epoch_ += 1000;
    sequence_number_ = 0;
  }
  return state().stopped ? "" : "it is no longer stopped";
}

std::string Suite::OldResume() {
  SendStop(state().stop_revision, false);
  const bool resumed = robot_.WaitUntil([&] { return !state().stopped; }, options_.quiet);
  return resumed ? "an order that is not newer than the stop resumed it" : "";
}

std::string Suite::Resume() {
  const Position before = state().position;
  SendStop(state().stop_revision + 1, false);
  if (!Soon([&] { return !state().stopped; })) return "its state does not confirm the order";
  if (auto why = Stays(before); !why.empty()) return why;
  return Expect(Next(CommandKind::kStop), CommandOutcome::kDone);
}

struct Clause {
  const char* name;
  const char* text;
  std::string (Suite::*check)();
};

constexpr Clause kClauses[] = {
    {"state", "a late joiner gets its state; it is free for commands", &Suite::Begins},
    {"map", "its map is latched, its stamp and size are in the state, and it stands on free ground",
     &Suite::Map},
    {"camera_info", "camera_info is latched", &Suite::Camera},
    {"move", "it drives to a place within the tolerance and reports running, then done",
     &Suite::Move},
    {"state rate", "a state at least every 0.5 s of its time, stamps never go back",
     &Suite::StateRate},
    {"repeat", "a repeated command changes nothing", &Suite::Repeat},
    {"sequence", "a command with an older sequence number changes nothing", &Suite::OldSequence},
    {"epoch", "a command of an older lease epoch changes nothing", &Suite::OldEpoch},
    {"epoch step", "a lease epoch more than 1,000,000 ahead changes nothing",
     &Suite::EpochFarAhead},
    {"name", "a command for another robot changes nothing", &Suite::OfAnotherRobot},
    {"malformed", "a malformed command changes nothing", &Suite::Malformed},
    {"expired", "a command that has expired on arrival ends as expired, and the robot stands",
     &Suite::ExpiredOnArrival},
    {"expiry", "a command that expires on the way ends as expired, and the robot stands",
     &Suite::ExpiredOnTheWay},
    {"replace", "a newer command replaces the one in force", &Suite::Replaced},
    {"obstacle", "a drive into an obstacle of its map ends as blocked or refused in front of it",
     &Suite::Blocked},
    {"view", "it turns, sends one snapshot with the next number and begins its path again",
     &Suite::View},
    {"stop", "a stop ends the command in force at once; the state confirms it", &Suite::Stop},
    {"stop epoch", "a stopped robot moves for no command, whatever its epoch",
     &Suite::StoppedForEveryEpoch},
    {"old resume", "an order to resume that is not newer than the stop changes nothing",
     &Suite::OldResume},
    {"resume", "a newer order resumes it; it waits for a new command", &Suite::Resume},
};

}  // namespace

std::vector<ClauseResult> CheckConformance(
    RobotUnderTest& robot, const ConformanceOptions& options,
    const std::function<void(const ClauseResult&)>& progress) {
  Suite suite(robot, options);
  std::vector<ClauseResult> results;
  bool goes_on = true;
  for (const Clause& clause : kClauses) {
    ClauseResult result{.name = clause.name, .clause = clause.text};
    if (goes_on) result.seen = (suite.*clause.check)();
    const bool not_checked = !goes_on || result.seen.starts_with('?');
    if (!goes_on) result.seen = "the clauses before are needed for it";
    if (result.seen.starts_with('?')) result.seen.erase(0, 1);
    result.verdict = not_checked           ? Verdict::kNotChecked
                     : result.seen.empty() ? Verdict::kHolds
                                           : Verdict::kBroken;
    // Without state, map and moves nothing else can be told.
    const bool needed = clause.check == &Suite::Begins || clause.check == &Suite::Map ||
                        clause.check == &Suite::Move;
    if (needed && result.verdict == Verdict::kBroken) goes_on = false;
    if (progress) progress(result);
    results.push_back(std::move(result));
  }
  return results;
}

}  // namespace conav::robot
