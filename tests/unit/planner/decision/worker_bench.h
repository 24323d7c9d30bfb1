#pragma once

#include <catch2/catch.hpp>
#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "planner/decision/robot_worker.h"

namespace conav::planner {

/// Gives the prepared decisions, and keeps the situations and maps that it saw.
class ScriptedMethod final : public Method {
 public:
  explicit ScriptedMethod(AwaitedInput awaits) : awaits_(awaits) {}

  Decision Decide(const Situation& situation, const StopToken&) override {
    seen.push_back(situation);
    if (while_deciding) while_deciding();
    return next;
  }
  void Prepare(const OccupancyGrid& map) override { prepared.push_back(map); }
  std::vector<Cell> IntendedPathFor(const Situation&) override { return {{1, 2}}; }
  AwaitedInput awaits() const override { return awaits_; }

  Decision next;
  std::function<void()> while_deciding;
  std::vector<Situation> seen;
  std::vector<OccupancyGrid> prepared;

 private:
  AwaitedInput awaits_;
};

inline RobotWorker::Options WorkerOptions() {
  return {.robot = "r1",
          .method_name = "scripted",
          .timeouts = {std::chrono::seconds(10), std::chrono::seconds(10)},
          .command_ttl = std::chrono::seconds(5)};
}

/// A worker of r1, with the board that it reads and all that it sends. The robot does what the test
/// says.
struct WorkerBench {
  explicit WorkerBench(AwaitedInput awaits = AwaitedInput::kAnswers,
                       RobotWorker::Options options = WorkerOptions()) {
    auto owned = std::make_unique<ScriptedMethod>(awaits);
    method = owned.get();
    method->next.action = Action{CommandKind::kMove, {1, 2}, 0.0};
    Start(std::move(owned), std::move(options));
  }
  explicit WorkerBench(std::unique_ptr<Method> other) { Start(std::move(other), WorkerOptions()); }

  void Start(std::unique_ptr<Method> of_worker, RobotWorker::Options options) {
    RobotWorker::Outputs outputs{
        .command = [this](const RobotCommand& command) { commands.push_back(command); },
        .report = [this](const SearchReport& report) { reports.push_back(report); },
        .attention = [this](const AttentionRequest& request) { attentions.push_back(request); },
        .plan = [](const RobotState&, const MapUpdate&, const std::vector<Cell>&) {},
        .intended_path = [this](const IntendedPath& path) { intended_paths.push_back(path); }};
    worker.emplace(std::move(options), std::move(of_worker), board, clock, std::move(outputs));
  }

  Clock::TimePoint Step() { return worker->Step(stop); }

  /// The robot took up the newest command.
  void Report(CommandOutcome outcome) {
    state.lease_epoch = commands.back().lease_epoch;
    state.command_sequence_number = commands.back().sequence_number;
    state.drive_order = commands.back().drive_order;
    state.command_outcome = outcome;
    board.Put(state);
  }

  void ReportAndStep(CommandOutcome outcome) {
    Report(outcome);
    Step();
  }
  void PutStateAndStep() {
    board.Put(state);
    Step();
  }

  Cell TargetOf(const RobotCommand& command) const {
    return state.grid.PositionToCell(command.path.at(0));
  }

  /// The next decision is to ask for guidance.
  void LetItAsk() {
    method->next = Decision{};
    method->next.attention = AttentionReason::kBlocked;
  }

  /// r0, which goes before r1, wants through r1's cell.
  void PutRobotThatGoesBefore() {
    board.Put(RobotState{.world = "w1", .robot = "r0", .cell = {1, 0}, .goals_left = {{4, 4}}});
    board.PutIntendedPath("r0", {{1, 1}, {1, 2}});
  }

  void PutAll() {
    board.Put(state);
    board.PutLens("r1", CameraLens{});
    board.PutMap("r1", MapUpdate{{}, 2.0, OccupancyGrid(5, 5, Occupancy::kFree)});
    board.Put(Belief{.world = "w1", .wall_probability = BeliefGrid(5, 5)});
    board.Put(guidance);
  }
  void PutAllAndStep() {
    PutAll();
    Step();
  }

  RobotState state{.world = "w1", .robot = "r1", .grid = {5, 5, 2.0}, .cell = {1, 1}};
  Guidance guidance{.robot = "r1", .revision = 1, .path = {{1, 1}}, .valid_until = {1000}};
  Blackboard board{{{"r0", "w1"}, {"r1", "w1"}}};
  FakeClock clock;
  ScriptedMethod* method = nullptr;  // null with a method of the test's own
  std::vector<RobotCommand> commands;
  std::vector<SearchReport> reports;
  std::vector<AttentionRequest> attentions;
  std::vector<IntendedPath> intended_paths;
  std::optional<RobotWorker> worker;
  StopToken stop;
};

}  // namespace conav::planner
