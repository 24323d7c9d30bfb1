#include "robot/conformance.h"

#include <fmt/core.h>

#include <algorithm>
#include <numbers>

#include "robot/conformance_probe.h"

namespace conav::robot {
namespace {

using namespace std::chrono_literals;
using Verdict = ClauseResult::Verdict;

constexpr auto kStatePeriod = 500ms;  // of the robot's time
/// While it drives it sends states at 4 Hz; a few may be lost on their way to us.
constexpr double kMovingPeriodS = 1.0 / 3.0;

bool Looks(double heading_rad, double asked_rad) {
  return std::abs(WrapAngle(heading_rad - asked_rad)) <= kHeadingTolerance;
}

bool IsNearObstacle(const OccupancyGrid& map, Cell place) {
  for (int i = 0; i < 9; ++i) {
    const Cell cell = place + Cell{i / 3 - 1, i % 3 - 1};
    if (map.Contains(cell) && map[cell] == Occupancy::kOccupied) return true;
  }
  return false;
}

/// The checks, in the order in which they are made; each leaves the robot standing, not stopped.
/// A check returns what it saw instead of what the clause promises; empty = the clause holds.
class Suite : public Probe {
 public:
  using Probe::Probe;

  std::string Begins();
  std::string Map();
  std::string Camera();
  std::string Move();
  std::string StateRate();
  std::string Repeat();
  std::string OldSequence();
  std::string OldEpoch();
  std::string FarAhead();
  std::string OfAnotherRobot();
  std::string Malformed();
  std::string ExpiredOnArrival();
  std::string ExpiredOnTheWay();
  std::string Replaced();
  std::string Path();
  std::string Blocked();
  std::string View();
  std::string Stop();
  std::string StoppedForEveryEpoch();
  std::string OldResume();
  std::string Resume();
  std::string AnyStop();
  std::string MapFirst();

 private:
  /// A stop of this revision, old or far ahead, must stop it and not count.
  std::string ExpectStopBy(std::uint64_t revision);
  RobotCommand moved_;  // the first drive
  Position home_;
};

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
  double moved_s = 0.0;
  int moving = 0;
  for (std::size_t i = 1; i < states.size(); ++i) {
    const double step_s = states[i].stamp.ToSeconds() - states[i - 1].stamp.ToSeconds();
    if (step_s < 0.0) return "stamps go back";
    if (states[i].stamp > states[i - 1].stamp + kStatePeriod) {
      return fmt::format("{:.2f} s of its time without a state, after {:.2f} s", step_s,
                         states[i - 1].stamp.ToSeconds());
    }
    if (step_s == 0.0 || states[i - 1].command_outcome != CommandOutcome::kRunning) continue;
    moved_s += step_s;
    ++moving;
  }
  if (moved_s <= kMovingPeriodS * moving) return states.size() > 1 ? "" : "one state only";
  return fmt::format("{} states in {:.2f} s of driving", moving, moved_s);
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

std::string Suite::FarAhead() {
  // Just too far, so that a robot that takes it is not lost for planners.
  RobotCommand by_epoch = Drive(home_);
  by_epoch.lease_epoch += kMaxCounterStep + 1;
  RobotCommand by_number = Drive(home_);
  by_number.sequence_number = state().command_sequence_number + kMaxCounterStep + 1;
  std::string why = ExpectIgnored(by_epoch);
  if (why.empty()) why = ExpectIgnored(by_number);
  epoch_ = state().lease_epoch;
  sequence_number_ = std::max(sequence_number_, state().command_sequence_number);
  return why;
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

std::string Suite::Path() {
  const auto place = FreePlace();
  if (!place) return fmt::format("its map has no free {} m around it to drive", StepM());
  RobotCommand command = Drive(*place);
  command.path.push_back(home_);
  command.arrival_heading_rad = WrapAngle(state().heading_rad + std::numbers::pi / 2.0);
  const auto earlier = static_cast<std::ptrdiff_t>(robot_.report().states.size());
  if (auto why = Expect(command, CommandOutcome::kDone); !why.empty()) return why;
  const std::vector<RobotState>& states = robot_.report().states;
  const double near_m = std::max(command.tolerance_m, StepM() / 2.0);
  if (std::none_of(states.begin() + earlier, states.end(), [&](const RobotState& one) {
        return Distance(one.position, *place) <= near_m;
      })) {
    return "it did not drive by the first place of its path";
  }
  if (const double off = Distance(state().position, home_); off > command.tolerance_m) {
    return fmt::format("it is {:.2f} m away from the last place of its path", off);
  }
  if (!Looks(state().heading_rad, *command.arrival_heading_rad)) {
    return fmt::format("it ended with heading {:.2f} rad and not {:.2f}", state().heading_rad,
                       *command.arrival_heading_rad);
  }
  return state().command_cell == state().grid.PositionToCell(home_)
             ? ""
             : "`command_place` is not the destination";
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
  const OccupancyGrid& map = robot_.report().map->cells;
  const Cell here = state().grid.PositionToCell(state().position);
  if (map[here] != Occupancy::kFree) return "it drove into the obstacle";
  if (!Soon([&] { return IsNearObstacle(map, state().command_cell); })) {
    return "`command_place` is no obstacle of its map";
  }
  return Distance(before, state().position) <= Distance(before, *place) ? "" : "it drove past it";
}

std::string Suite::View() {
  RobotCommand command = Next(CommandKind::kTransmitView);
  command.heading_rad = WrapAngle(state().heading_rad + std::numbers::pi / 2.0);
  const std::uint64_t number = state().snapshots + 1;
  const SimTime sent = state().stamp;
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
  if (!Looks(snapshot.heading_rad, command.heading_rad)) {
    return fmt::format("it looked towards {:.2f} rad and not {:.2f}", snapshot.heading_rad,
                       command.heading_rad);
  }
  if (snapshot.stamp < sent || snapshot.stamp > state().stamp) {
    return fmt::format(
        "the stamp of the snapshot is {:.2f} s; it was sent between {:.2f} and {:.2f} s",
        snapshot.stamp.ToSeconds(), sent.ToSeconds(), state().stamp.ToSeconds());
  }
  if (const double off = Distance(snapshot.position, state().position); off > kDriftM) {
    return fmt::format("the pose of the snapshot is {:.2f} m away from it", off);
  }
  if (!AreAligned(snapshot.grid, state().grid))
    return "`map_info` of the snapshot is not its map's";
  if (snapshot.visible.free.empty() && snapshot.visible.walls.empty()) return "`view` is empty";
  return state().path.size() == 1 ? "" : "`path` did not begin again at the picture";
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
  const bool resumed = Happens([&] { return !state().stopped; });
  return resumed ? "an order that is not newer than the stop resumed it" : "";
}

std::string Suite::Resume() {
  const Position before = state().position;
  SendStop(state().stop_revision + 1, false);
  if (!Soon([&] { return !state().stopped; })) return "its state does not confirm the order";
  if (auto why = Stays(before); !why.empty()) return why;
  return Expect(Next(CommandKind::kStop), CommandOutcome::kDone);
}

std::string Suite::ExpectStopBy(std::uint64_t revision) {
  const std::uint64_t newest = state().stop_revision;
  SendStop(revision, true);
  if (!Soon([&] { return state().stopped; })) {
    return fmt::format("a stop of revision {} after {} did not stop it", revision, newest);
  }
  SendStop(revision + 1, false);
  if (Happens([&] { return !state().stopped; })) {
    return fmt::format("revision {} resumed it after {}", revision + 1, newest);
  }
  if (state().stop_revision != newest) {
    return fmt::format("it counts revision {} after {} as the newest", revision, newest);
  }
  SendStop(newest + 1, false);
  return Soon([&] { return !state().stopped; }) ? "" : "the next order did not resume it";
}

std::string Suite::AnyStop() {
  // Just too far, so that a robot that counts it can still be resumed.
  std::string why = ExpectStopBy(state().stop_revision + kMaxCounterStep + 1);
  if (why.empty()) why = ExpectStopBy(1);
  if (state().stopped) SendStop(state().stop_revision + 1, false);
  return why;
}

std::string Suite::MapFirst() {
  const RobotReport& report = robot_.report();
  if (report.maps_published.size() < 2) return "?its map did not change";
  for (const auto& [stamp, published] : report.maps_published) {
    const auto named = report.maps_named.find(stamp);
    if (named != report.maps_named.end() && published > named->second) {
      return fmt::format("a state named the map of {:.2f} s before it came", stamp.ToSeconds());
    }
  }
  return "";
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
    {"state rate", "states at 4 Hz while it moves, else every 0.5 s; stamps never go back",
     &Suite::StateRate},
    {"repeat", "a repeated command changes nothing", &Suite::Repeat},
    {"sequence", "a command with an older sequence number changes nothing", &Suite::OldSequence},
    {"epoch", "a command of an older lease epoch changes nothing", &Suite::OldEpoch},
    {"far ahead", "a lease epoch or sequence number more than 1,000,000 ahead changes nothing",
     &Suite::FarAhead},
    {"name", "a command for another robot changes nothing", &Suite::OfAnotherRobot},
    {"malformed", "a malformed command changes nothing", &Suite::Malformed},
    {"expired", "a command that has expired on arrival ends as expired, and the robot stands",
     &Suite::ExpiredOnArrival},
    {"expiry", "a command that expires on the way ends as expired, and the robot stands",
     &Suite::ExpiredOnTheWay},
    {"replace", "a newer command replaces the one in force", &Suite::Replaced},
    {"path", "it drives along several places and ends with the heading asked for", &Suite::Path},
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
    {"any stop", "a stop of any revision stops it; one more than 1,000,000 ahead does not count",
     &Suite::AnyStop},
    {"map first", "each map comes before the state that names it", &Suite::MapFirst},
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
