#pragma once

#include <catch2/catch.hpp>
#include <map>
#include <string>
#include <vector>

#include "operator/console/console_messages.h"
#include "operator/console/console_state.h"
#include "unit/common/msg/samples.h"
#include "unit/operator/support/updates.h"

namespace conav::operators {

using Kind = console::Update;

inline RobotState At(std::int64_t stamp_s, Cell cell, std::vector<Cell> path = {},
                     const std::string& robot = "r1", const std::string& world = "w1") {
  const std::uint64_t moves = path.empty() ? 0 : path.size() - 1;
  return {.stamp = {stamp_s * 1'000'000'000},
          .world = world,
          .robot = robot,
          .cell = cell,
          .path = std::move(path),
          .cell_moves = moves};
}

inline Snapshot SnapshotOf(std::uint64_t number, const std::string& robot = "r1") {
  Snapshot snapshot = samples::SampleSnapshot();
  snapshot.robot = robot;
  snapshot.sequence_number = number;
  return snapshot;
}

inline Guidance Answering(std::uint64_t snapshot) {
  Guidance guidance = samples::SampleGuidance();
  guidance.answers_snapshot = snapshot;
  return guidance;
}

inline MapUpdate MapOf(int rows, int columns) {
  return {{}, 2.0, OccupancyGrid(rows, columns, Occupancy::kUnknown)};
}

/// The log and what is folded into it.
struct StateBench {
  UpdateLog log;
  ConsoleState state{log, console::Session()};

  /// Of r1: "1,1 1,2", over all pieces.
  std::string Trail() const {
    std::string text;
    std::uint32_t next = 0;
    std::map<std::uint32_t, console::Trail> pieces;
    for (const auto& update : AllOf(log, Kind::kTrail)) {
      if (update.trail().robot() == "r1") pieces[update.trail().first()] = update.trail();
    }
    for (const auto& [first, piece] : pieces) {
      CHECK(first == next);
      for (const auto& cell : piece.cells()) {
        if (!text.empty()) text += ' ';
        text += std::to_string(cell.row()) + ',' + std::to_string(cell.column());
        ++next;
      }
    }
    return text;
  }

  std::vector<console::SnapshotAnswer> Answers() const {
    std::map<std::uint64_t, console::SnapshotAnswer> answers;
    for (const auto& update : AllOf(log, Kind::kSnapshot)) {
      answers[update.snapshot().sequence_number()] = update.snapshot().answer();
    }
    std::vector<console::SnapshotAnswer> in_order;
    for (const auto& [number, answer] : answers) in_order.push_back(answer);
    return in_order;
  }
};

using Answers = std::vector<console::SnapshotAnswer>;

}  // namespace conav::operators
