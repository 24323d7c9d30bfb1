#include "robot/conformance.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <deque>

#include "robot/command_gate.h"

namespace conav::robot {
namespace {

using namespace std::chrono_literals;
using Verdict = ClauseResult::Verdict;

/// What a driver may get wrong.
enum class Fault {
  kNone,
  kNoState,
  kNoMap,
  kNoCamera,
  kInaccurate,        // stops 1 m short
  kRareStates,        // every 2 s of its time
  kSlowStates,        // every 0.5 s of its time while it drives
  kTakesRepeats,      // drives again on a repeat
  kTakesOldSequence,  // no gate at all for these
  kTakesOldEpoch,
  kTakesAnyEpoch,
  kTakesAnySequence,
  kTakesOthers,
  kTakesMalformed,
  kIgnoresExpiry,
  kGoesOnAfterExpiry,
  kQueues,       // ignores newer commands while it drives
  kSkipsPlaces,  // drives straight to the last one
  kNoTurn,
  kNoCommandPlace,
  kThroughWalls,
  kNoSnapshot,
  kOldPicture,        // of the start, by its stamp
  kPictureElsewhere,  // 1 m away
  kPictureOfAnotherMap,
  kKeepsPath,
  kIgnoresStop,
  kConfirmsOnly,      // says stopped, drives on
  kMovesWhenStopped,  // for a new epoch
  kOldResume,
  kGoesOnWhenResumed,
  kIgnoresOldStop,  // takes stops in their order only
  kCountsFarStop,
  kResumesFarAhead,
  kLateMap,  // after the state that names it
};

/// A driver of a robot in a hall of 9 x 9 cells of 1 m with a wall in the middle column, made of
/// CommandGate, in simulated time: a wait of 10 ms is one step of 0.1 s. Takes no walls into account
/// but those of its way.
class Driver final : public RobotUnderTest {
 public:
  explicit Driver(Fault fault) : fault_(fault) {
    map_.cell_size_m = 1.0;
    map_.cells = OccupancyGrid(9, 9, Occupancy::kFree);
    for (int row = 0; row < 9; ++row) map_.cells[{row, 4}] = Occupancy::kOccupied;
    state_.robot = "r1";
    state_.world = "w1";
    state_.grid = {9, 9, 1.0};
    place_ = state_.grid.CellToPosition({4, 2});
    path_ = {{4, 2}};
    PublishMap();
    if (fault != Fault::kNoCamera) report_.lens = CameraLens{};
    Publish();
  }

  const RobotReport& report() const override { return report_; }
  bool WaitUntil(const std::function<bool()>& done, std::chrono::milliseconds patience) override {
    for (auto waited = 0ms; !done(); waited += 10ms) {
      if (waited >= patience) return false;
      Step();
    }
    return true;
  }
  void Send(const StopOrder& order) override {
    if (fault_ == Fault::kIgnoresStop) return;
    const bool old = order.revision <= state_.stop_revision;
    const bool far = order.revision > state_.stop_revision + kMaxCounterStep;
    if (fault_ == Fault::kIgnoresOldStop && old) return;
    StopOrder taken = order;
    if (fault_ == Fault::kOldResume && !order.stopped) taken.revision += 1;
    if (fault_ == Fault::kResumesFarAhead && far && !order.stopped) {
      taken.revision = state_.stop_revision + 1;
    }
    if (fault_ == Fault::kCountsFarStop && far && order.stopped) counted_far_ = order.revision;
    gate_.Receive(taken);
    if (fault_ == Fault::kGoesOnWhenResumed && !order.stopped && !gate_.stopped()) {
      speed_mps_ = 0.3;
      goal_ = Position{place_.x_m, place_.y_m + 2.0};
    } else if (fault_ != Fault::kConfirmsOnly) {
      goal_.reset();
    }
    Publish();
  }
  void SendMalformed(const RobotCommand& command) override {
    if (fault_ == Fault::kTakesMalformed) Send(command);
  }
  void Send(const RobotCommand& sent) override {
    RobotCommand command = sent;
    const bool last = command.lease_epoch == gate_.command().lease_epoch &&
                      command.sequence_number == gate_.command().sequence_number;
    if (fault_ == Fault::kTakesRepeats && last) command.sequence_number += 1;
    if (fault_ == Fault::kTakesOldSequence && command.sequence_number == 0) {
      command.sequence_number = gate_.command().sequence_number + 1;
    }
    if (fault_ == Fault::kTakesOldEpoch && command.lease_epoch < gate_.command().lease_epoch) {
      command.lease_epoch = gate_.command().lease_epoch;
    }
    if (fault_ == Fault::kTakesAnyEpoch &&
        command.lease_epoch > gate_.command().lease_epoch + kMaxCounterStep) {
      command.lease_epoch = gate_.command().lease_epoch;
    }
    if (fault_ == Fault::kTakesAnySequence && command.sequence_number > kMaxCounterStep) {
      command.sequence_number = gate_.command().sequence_number + 1;
    }
    if (fault_ == Fault::kTakesOthers) command.robot = "r1";
    if (fault_ == Fault::kIgnoresExpiry && command.expires_at <= now_) {
      command.expires_at = now_ + 60s;
    }
    if (fault_ == Fault::kQueues && gate_.active()) return;
    const auto admission = gate_.Receive(command, now_);
    if (!admission || *admission == CommandGate::Admission::kRepeated) return;
    const bool moves_anyway = fault_ == Fault::kMovesWhenStopped && gate_.stopped();
    if (*admission == CommandGate::Admission::kEnded && !moves_anyway) return Publish();
    Begin(command);
    Publish();
  }

 private:
  void Begin(const RobotCommand& command) {
    goal_.reset();
    switch (command.kind) {
      case CommandKind::kMove:
        return BeginMove(command);
      case CommandKind::kTransmitView:
        return TakeView(command);
      default:
        return gate_.End(CommandOutcome::kDone);
    }
  }
  void BeginMove(const RobotCommand& command) {
    const Cell to = state_.grid.PositionToCell(command.path.back());
    if (fault_ != Fault::kNoCommandPlace) state_.command_cell = to;
    if (map_.cells[to] == Occupancy::kOccupied && fault_ != Fault::kThroughWalls) {
      return gate_.End(CommandOutcome::kBlocked, "a wall");
    }
    rest_.assign(command.path.begin(), command.path.end());
    if (fault_ == Fault::kSkipsPlaces) rest_ = {command.path.back()};
    goal_ = rest_.front();
    rest_.pop_front();
    speed_mps_ = 1.0;
  }
  void TakeView(const RobotCommand& command) {
    heading_rad_ = command.heading_rad;
    ++snapshots_;
    if (fault_ != Fault::kNoSnapshot) {
      const double off_m = fault_ == Fault::kPictureElsewhere ? 1.0 : 0.0;
      const double cell_size_m = fault_ == Fault::kPictureOfAnotherMap ? 0.5 : 1.0;
      report_.snapshot = Snapshot{.stamp = fault_ == Fault::kOldPicture ? SimTime{} : now_,
                                  .robot = "r1",
                                  .sequence_number = snapshots_,
                                  .grid = {9, 9, cell_size_m},
                                  .position = {place_.x_m + off_m, place_.y_m},
                                  .heading_rad = heading_rad_,
                                  .visible = {{{4, 2}}, {}}};
    }
    if (fault_ != Fault::kKeepsPath) path_ = {state_.grid.PositionToCell(place_)};
    gate_.End(CommandOutcome::kDone);
  }
  void Step() {
    now_ = now_ + 100ms;
    if (fault_ != Fault::kGoesOnAfterExpiry) {
      if (gate_.EndIfExpired(now_)) goal_.reset();
    } else {
      gate_.EndIfExpired(now_);
    }
    if (goal_) Drive();
    const auto silent = std::chrono::nanoseconds(now_.nanoseconds - published_.nanoseconds);
    const bool rare = fault_ == Fault::kRareStates && silent < 2s;
    const bool slow = fault_ == Fault::kSlowStates && silent < 500ms;
    if (!(rare || slow) || !gate_.active()) Publish();
  }
  void Drive() {
    const double dx = goal_->x_m - place_.x_m;
    const double dy = goal_->y_m - place_.y_m;
    const double left = std::hypot(dx, dy) - (fault_ == Fault::kInaccurate ? 0.9 : 0.0);
    const double step = std::min(left, 0.1 * speed_mps_);
    if (step <= 1e-9) return Arrive();
    const double length = std::hypot(dx, dy);
    place_ = {place_.x_m + dx / length * step, place_.y_m + dy / length * step};
    distance_m_ += step;
  }
  void Arrive() {
    path_.push_back(state_.grid.PositionToCell(place_));
    map_.stamp = now_;
    state_.map_stamp = now_;
    if (fault_ == Fault::kLateMap) Publish();
    PublishMap();
    goal_.reset();
    if (!rest_.empty()) {
      goal_ = rest_.front();
      return rest_.pop_front();
    }
    if (!gate_.active()) return;
    if (fault_ != Fault::kNoTurn) {
      heading_rad_ = gate_.command().arrival_heading_rad.value_or(heading_rad_);
    }
    gate_.End(CommandOutcome::kDone);
  }
  RobotReport::Published::mapped_type Sent() {
    return RobotReport::Published::mapped_type(std::chrono::microseconds(++messages_));
  }
  void PublishMap() {
    if (fault_ == Fault::kNoMap) return;
    report_.map = map_;
    report_.maps_published.try_emplace(map_.stamp, Sent());
  }
  void Publish() {
    if (fault_ == Fault::kNoState) return;
    published_ = now_;
    state_.stamp = now_;
    state_.position = place_;
    state_.heading_rad = heading_rad_;
    state_.speed_mps = goal_ ? speed_mps_ : 0.0;
    state_.path = path_;
    state_.distance_m = distance_m_;
    state_.snapshots = snapshots_;
    gate_.Report(state_);
    state_.stop_revision = std::max(state_.stop_revision, counted_far_);
    report_.maps_named.try_emplace(state_.map_stamp, Sent());
    report_.state = state_;
    report_.states.push_back(state_);
  }

  Fault fault_;
  CommandGate gate_{"r1"};
  MapUpdate map_;
  RobotState state_;
  RobotReport report_;
  SimTime now_;
  SimTime published_;
  Position place_;
  std::vector<Cell> path_;
  std::optional<Position> goal_;
  std::deque<Position> rest_;  // after the goal
  double speed_mps_ = 0.0;
  double heading_rad_ = 0.0;
  double distance_m_ = 0.0;
  std::uint64_t snapshots_ = 0;
  std::uint64_t counted_far_ = 0;
  int messages_ = 0;
};

/// Names of the clauses that the driver breaks.
std::vector<std::string> Broken(Fault fault) {
  Driver driver(fault);
  std::vector<std::string> names;
  for (const ClauseResult& result : CheckConformance(driver, {})) {
    if (result.verdict == Verdict::kBroken) names.push_back(result.name);
  }
  return names;
}

TEST_CASE("a driver made of the command gate keeps every clause", "[robot][conformance]") {
  Driver driver(Fault::kNone);
  for (const ClauseResult& result : CheckConformance(driver, {})) {
    CAPTURE(result.name, result.seen);
    CHECK(result.verdict == Verdict::kHolds);
  }
}

TEST_CASE("each fault of a driver breaks the clause that forbids it", "[robot][conformance]") {
  struct Row {
    Fault fault;
    std::string clause;
  };
  for (const Row& row : std::vector<Row>{{Fault::kNoState, "state"},
                                         {Fault::kNoMap, "map"},
                                         {Fault::kNoCamera, "camera_info"},
                                         {Fault::kInaccurate, "move"},
                                         {Fault::kRareStates, "state rate"},
                                         {Fault::kSlowStates, "state rate"},
                                         {Fault::kTakesRepeats, "repeat"},
                                         {Fault::kTakesOldSequence, "sequence"},
                                         {Fault::kTakesOldEpoch, "epoch"},
                                         {Fault::kTakesAnyEpoch, "far ahead"},
                                         {Fault::kTakesAnySequence, "far ahead"},
                                         {Fault::kTakesOthers, "name"},
                                         {Fault::kTakesMalformed, "malformed"},
                                         {Fault::kIgnoresExpiry, "expired"},
                                         {Fault::kGoesOnAfterExpiry, "expiry"},
                                         {Fault::kQueues, "replace"},
                                         {Fault::kSkipsPlaces, "path"},
                                         {Fault::kNoTurn, "path"},
                                         {Fault::kNoCommandPlace, "path"},
                                         {Fault::kNoCommandPlace, "obstacle"},
                                         {Fault::kThroughWalls, "obstacle"},
                                         {Fault::kNoSnapshot, "view"},
                                         {Fault::kOldPicture, "view"},
                                         {Fault::kPictureElsewhere, "view"},
                                         {Fault::kPictureOfAnotherMap, "view"},
                                         {Fault::kKeepsPath, "view"},
                                         {Fault::kIgnoresStop, "stop"},
                                         {Fault::kConfirmsOnly, "stop"},
                                         {Fault::kMovesWhenStopped, "stop epoch"},
                                         {Fault::kOldResume, "old resume"},
                                         {Fault::kGoesOnWhenResumed, "resume"},
                                         {Fault::kIgnoresOldStop, "any stop"},
                                         {Fault::kCountsFarStop, "any stop"},
                                         {Fault::kResumesFarAhead, "any stop"},
                                         {Fault::kLateMap, "map first"}}) {
    CAPTURE(row.clause, static_cast<int>(row.fault));
    const auto broken = Broken(row.fault);
    CAPTURE(broken);
    CHECK(std::ranges::find(broken, row.clause) != broken.end());
  }
}

TEST_CASE("without a map nothing behind it is checked", "[robot][conformance]") {
  Driver driver(Fault::kNoMap);
  const auto results = CheckConformance(driver, {});
  CHECK(results.back().verdict == Verdict::kNotChecked);
}

}  // namespace
}  // namespace conav::robot
