#include "robot/conformance.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "robot/command_gate.h"

namespace conav::robot {
namespace {

using namespace std::chrono_literals;
using Verdict = ClauseResult::Verdict;

/// What a driver may get wrong.
enum class Fault {
  kNone,
  kNoMap,
  kNoCamera,
  kInaccurate,        // stops 1 m short
  kRareStates,        // every 2 s of its time
  kTakesRepeats,      // drives again on a repeat
  kTakesOldSequence,  // no gate at all for these
  kTakesOldEpoch,
  kTakesAnyEpoch,
  kTakesOthers,
  kTakesMalformed,
  kIgnoresExpiry,
  kGoesOnAfterExpiry,
  kQueues,  // ignores newer commands while it drives
  kThroughWalls,
  kNoSnapshot,
  kKeepsPath,
  kIgnoresStop,
  kConfirmsOnly,      // says stopped, drives on
  kMovesWhenStopped,  // for a new epoch
  kOldResume,
  kGoesOnWhenResumed,
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
    if (fault != Fault::kNoMap) report_.map = map_;
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
    if (fault_ == Fault::kOldResume && !order.stopped) {
      StopOrder newer = order;
      newer.revision += 1;
      gate_.Receive(newer);
    } else {
      gate_.Receive(order);
    }
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
    if (fault_ == Fault::kTakesAnyEpoch && command.lease_epoch == ~std::uint64_t{0}) {
      command.lease_epoch = gate_.command().lease_epoch;
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
    if (map_.cells[to] == Occupancy::kOccupied && fault_ != Fault::kThroughWalls) {
      return gate_.End(CommandOutcome::kBlocked, "a wall");
    }
    goal_ = command.path.back();
    speed_mps_ = 1.0;
  }
  void TakeView(const RobotCommand& command) {
    heading_rad_ = command.heading_rad;
    ++snapshots_;
    if (fault_ != Fault::kNoSnapshot) {
      report_.snapshot = Snapshot{.robot = "r1",
                                  .sequence_number = snapshots_,
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
    const bool due = now_.nanoseconds - published_.nanoseconds >= 2'000'000'000;
    if (fault_ != Fault::kRareStates || due || !gate_.active()) Publish();
  }
  void Drive() {
    const double dx = goal_->x_m - place_.x_m;
    const double dy = goal_->y_m - place_.y_m;
    const double left = std::hypot(dx, dy) - (fault_ == Fault::kInaccurate ? 0.9 : 0.0);
    const double step = std::min(left, 0.1 * speed_mps_);
    if (step <= 1e-9) {
      goal_.reset();
      path_.push_back(state_.grid.PositionToCell(place_));
      if (gate_.active()) gate_.End(CommandOutcome::kDone);
      return;
    }
    const double length = std::hypot(dx, dy);
    place_ = {place_.x_m + dx / length * step, place_.y_m + dy / length * step};
    distance_m_ += step;
  }
  void Publish() {
    published_ = now_;
    state_.stamp = now_;
    state_.position = place_;
    state_.heading_rad = heading_rad_;
    state_.speed_mps = goal_ ? speed_mps_ : 0.0;
    state_.path = path_;
    state_.distance_m = distance_m_;
    state_.snapshots = snapshots_;
    gate_.Report(state_);
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
  double speed_mps_ = 0.0;
  double heading_rad_ = 0.0;
  double distance_m_ = 0.0;
  std::uint64_t snapshots_ = 0;
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
  for (const Row& row : std::vector<Row>{{Fault::kNoMap, "map"},
                                         {Fault::kNoCamera, "camera_info"},
                                         {Fault::kInaccurate, "move"},
                                         {Fault::kRareStates, "state rate"},
                                         {Fault::kTakesRepeats, "repeat"},
                                         {Fault::kTakesOldSequence, "sequence"},
                                         {Fault::kTakesOldEpoch, "epoch"},
                                         {Fault::kTakesAnyEpoch, "epoch step"},
                                         {Fault::kTakesOthers, "name"},
                                         {Fault::kTakesMalformed, "malformed"},
                                         {Fault::kIgnoresExpiry, "expired"},
                                         {Fault::kGoesOnAfterExpiry, "expiry"},
                                         {Fault::kQueues, "replace"},
                                         {Fault::kThroughWalls, "obstacle"},
                                         {Fault::kNoSnapshot, "view"},
                                         {Fault::kKeepsPath, "view"},
                                         {Fault::kIgnoresStop, "stop"},
                                         {Fault::kConfirmsOnly, "stop"},
                                         {Fault::kMovesWhenStopped, "stop epoch"},
                                         {Fault::kOldResume, "old resume"},
                                         {Fault::kGoesOnWhenResumed, "resume"}}) {
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
