#pragma once

#include <algorithm>
#include <catch2/catch.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "operator/replay/timeline.h"
#include "unit/operator/console/state_bench.h"

namespace conav::operators {

constexpr double kBegin = 1e9;  // s since 1970
constexpr double kNow = 2e9;

inline console::Session SessionOfOne() {
  console::Session session;
  session.add_robots("r1");
  session.add_worlds("w1");
  return session;
}

inline OccupancyGrid SmallMaze(Occupancy middle) {
  OccupancyGrid cells(3, 4, Occupancy::kFree);
  cells[{1, 1}] = middle;
  return cells;
}

inline Belief BeliefOf(std::uint64_t revision, float middle) {
  Belief belief{{}, "w1", revision, BeliefGrid(3, 4, 0.0F), revision == 0 ? "" : "anna/1"};
  belief.wall_probability[{1, 1}] = middle;
  return belief;
}

inline Guidance PathOf(std::uint64_t revision, std::vector<Cell> path, std::uint64_t answers) {
  return {.world = "w1",
          .robot = "r1",
          .revision = revision,
          .path = std::move(path),
          .given_by = "anna/1",
          .answers_snapshot = answers,
          .valid_until = SimTime::FromSeconds(600.0)};
}

inline Snapshot SentSnapshot(std::uint64_t number) {
  Snapshot snapshot = SnapshotOf(number);
  snapshot.streamed = false;
  return snapshot;
}

/// A run of one robot: s after its begin.
///   0 maps, revision 0    1 state in (1,1)    2 (1,2)    3 picture 1    4 revision 1, a path for the
///   picture, a line of the log    5 (1,3), its first goal    8 picture 2    9 nothing new    10 (1,3)
inline Timeline SmallRun() {
  TimelineBuilder builder(SessionOfOne());
  const auto at = [](double s) { return kBegin + s; };
  builder.ReceiveInitialMap(at(0), "w1", {{}, 2.0, SmallMaze(Occupancy::kFree)});
  builder.ReceiveTruth(at(0), "w1", {{}, 2.0, SmallMaze(Occupancy::kOccupied)});
  builder.Receive(at(0), BeliefOf(0, 0.0F));
  builder.Receive(at(1), At(1, {1, 1}));
  builder.Receive(at(2), At(2, {1, 2}, {{1, 1}, {1, 2}}));
  builder.Receive(at(3), SentSnapshot(1));
  builder.Receive(at(4), BeliefOf(1, 1.0F));
  builder.Receive(at(4), PathOf(1, {{1, 2}, {1, 3}}, 1));
  builder.Receive(at(4), OperatorEvent{.kind = RequestKind::kEdit, .client = "anna/1"});
  RobotState third = At(5, {1, 3}, {{1, 1}, {1, 2}, {1, 3}});
  third.goals_reached = {{1, 3}};
  third.goals_total = 2;
  builder.Receive(at(5), third);
  builder.Receive(at(8), SentSnapshot(2));
  builder.Receive(at(9), PathOf(2, {{1, 2}, {1, 3}}, 2));
  third.stamp = SimTime::FromSeconds(10.0);
  builder.Receive(at(10), third);
  return std::move(builder).Finish();
}

inline std::vector<console::MarkKind> KindsOf(const Timeline& timeline) {
  std::vector<console::MarkKind> kinds;
  for (const console::Mark& mark : timeline.marks) kinds.push_back(mark.kind());
  return kinds;
}

/// A timeline, and what pages see of it.
struct ReplayBench {
  explicit ReplayBench(Timeline run = SmallRun()) : timeline(std::move(run)) {}

  void Seek(double position_s) { player.Seek(position_s, std::nullopt, now_s); }
  void Advance(double elapsed_s) {
    now_s += elapsed_s;
    player.Advance(elapsed_s, now_s);
  }
  console::Robot Robot() const { return OnlyOf(log, Kind::kRobot).robot(); }
  std::uint64_t Revision() const { return OnlyOf(log, Kind::kBelief).belief().revision(); }
  console::Playback Playback() const { return OnlyOf(log, Kind::kPlayback).playback(); }
  std::vector<std::uint64_t> Snapshots() const {
    std::vector<std::uint64_t> numbers;
    for (const auto& update : AllOf(log, Kind::kSnapshot)) {
      numbers.push_back(update.snapshot().sequence_number());
    }
    return numbers;
  }
  /// Where robots are.
  std::vector<int> Cells() const {
    std::vector<int> columns;
    for (const auto& update : AllOf(log, Kind::kRobot)) {
      columns.push_back(update.robot().cell().column());
    }
    return columns;
  }
  /// What a page without any knowledge would get, but for sequence numbers and order.
  std::vector<std::string> Everything() const {
    std::vector<std::string> all;
    for (console::Update update : AllOf(log)) {
      update.clear_sequence();
      all.push_back(update.ShortDebugString());
    }
    std::sort(all.begin(), all.end());
    return all;
  }

  Timeline timeline;
  UpdateLog log;
  FrameSlots frames;
  SnapshotStore snapshots{1U << 20U};
  double now_s = kNow;
  ReplayPlayer player{timeline, {log, frames, snapshots}, kNow};
};

}  // namespace conav::operators
