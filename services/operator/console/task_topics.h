#pragma once

#include <optional>
#include <string>

#include "common/bus/participant.h"
#include "common/bus/subscriber.h"
#include "common/runtime/clock.h"
#include "operator/belief/belief_store.h"
#include "operator/config.h"
#include "operator/console/participant_task.h"
#include "operator/supervision/control.h"

// One user: the service; apart because it knows the bus.

namespace conav::operators {

/// The operator service's part of a mapping task or a study: receives the true maze, decides when
/// the participant may finish, and writes the result.
///
/// The result file is on disk before a Finish is acknowledged; with such a file from before, the
/// maze is finished from the start. The time of the beginning is not kept over a restart: the
/// duration counts from there.
/// Threads: one, the service's.
class TaskTopics {
 public:
  /// `participant`, `store` and `clock` outlive it. Throws StartupError: the robots are in several
  /// worlds; the result file is there and cannot be read, or could not be written.
  TaskTopics(bus::Participant& participant, const OperatorConfig& config, BeliefStore& store,
             const Clock& clock);

  void Step();
  void Receive(const RobotState& state) { task_.Receive(state); }
  /// Whether a robot was resumed, which begins the task.
  void Receive(const ControlRegistry& control);

  std::string CheckAllowed(const OperatorRequest& request) const {
    return task_.CheckAllowed(request);
  }
  /// Requires a FinishRequest. When only the reply cannot be stored, the maze is finished all the
  /// same.
  BeliefStore::Answer Finish(const OperatorRequest& request);
  bool finished() const { return task_.phase() == TaskPhase::kFinished; }

  TaskStatus status() const;

 private:
  Result<TaskResult> Measure();
  Result<void> WriteResult(const TaskResult& result);
  void Adopt(const TaskResult& result);

  TaskOptions options_;
  std::string world_;
  BeliefStore& store_;
  const Clock& clock_;
  bus::Subscriber<nav_msgs::msg::OccupancyGrid> truth_;
  ParticipantTask task_;
  Clock::TimePoint began_{};
  double began_at_s_ = 0.0;  // wall time, s since 1970
  TaskResult result_;
};

}  // namespace conav::operators
