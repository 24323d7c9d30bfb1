#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "common/grid/map_accuracy.h"
#include "common/protocol/robot.h"
#include "common/protocol/supervision.h"
#include "common/runtime/result.h"

namespace conav::operators {

enum class TaskKind {
  kMapping,  // the robot finds its own way
  kStudy,    // the participant guides or drives it, as the method says
};

enum class TaskPhase {
  kWaiting,  // the robots stand until the participant lets them go
  kRunning,
  kFinished,  // the map stays as it is
};

/// What a page is told.
struct TaskStatus {
  std::string participant;
  int number = 1;               // of the maze
  int count = 1;                // of mazes
  std::vector<double> earlier;  // mapping accuracies of the mazes before
  TaskPhase phase = TaskPhase::kWaiting;
  std::uint32_t goals_left = 0;
  bool may_finish = false;
  double mapping_accuracy = 0.0;  // once it is finished
  double cell_accuracy = 0.0;     // likewise
  bool operator==(const TaskStatus&) const = default;
};

/// How the participant did.
struct TaskResult {
  double mapping_accuracy = 0.0;
  double cell_accuracy = 0.0;
  double initial_cell_accuracy = 0.0;
  int wrong_at_first = 0;   // cells of the map
  int corrected = 0;        // of these
  int broken = 0;           // cells that were right at first
  std::uint64_t edits = 0;  // requests that changed the map
  std::uint64_t pictures = 0;
  std::uint32_t goals = 0;
  bool operator==(const TaskResult&) const = default;
};

/// One maze of the mapping task (paper, Appendix A), or of a study, as the participant goes through
/// it: begins when a robot is let go, may be finished as soon as the robots have reached all goals,
/// and then the map stays as it is. Pure; threads: not synchronised.
class ParticipantTask {
 public:
  /// `robots`: those of the maze.
  explicit ParticipantTask(std::set<std::string> robots, TaskKind kind = TaskKind::kMapping)
      : robots_(std::move(robots)), kind_(kind) {}

  void Hear(const RobotState& state);
  /// The true maze.
  void Hear(const OccupancyGrid& truth) { truth_ = truth; }
  /// A robot was let go; of no effect later than at the beginning.
  void Begin();

  TaskPhase phase() const { return phase_; }
  std::uint32_t goals_left() const;

  /// Why the task forbids `request`; empty = it does not.
  std::string WhyNot(const OperatorRequest& request) const;
  /// Why the participant may not finish; empty = they may.
  std::string WhyNotFinish() const;
  /// What it would be with the map as it is now, which was `initial` at first. Errors: kRefused with
  /// WhyNotFinish(), or when the maps do not belong together.
  [[nodiscard]] Result<TaskResult> Measure(const Belief& belief, const BeliefGrid& initial) const;
  void Finish() { phase_ = TaskPhase::kFinished; }

 private:
  struct Robot {
    std::uint32_t goals_left = 0;
    std::uint32_t goals = 0;
    std::uint64_t pictures = 0;
  };

  std::set<std::string> robots_;
  TaskKind kind_;
  std::map<std::string, Robot> heard_;
  std::optional<OccupancyGrid> truth_;
  TaskPhase phase_ = TaskPhase::kWaiting;
};

}  // namespace conav::operators
