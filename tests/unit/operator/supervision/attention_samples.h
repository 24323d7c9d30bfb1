#pragma once

#include <string>

#include "operator/supervision/attention_queue.h"

/// Messages of robots of world w1, for the tests of the attention queue.
namespace conav::operators {

inline SimTime At(double seconds) { return SimTime::FromSeconds(seconds); }

inline RobotState WorkingRobot(const std::string& robot,
                               CommandOutcome outcome = CommandOutcome::kNone) {
  return {.world = "w1",
          .robot = robot,
          .goals_left = {{1, 1}},
          .command_sequence_number = 1,
          .command_outcome = outcome};
}

inline AttentionRequest Question(const std::string& robot, AttentionReason reason,
                                 double value_lost_per_s, std::uint64_t sequence_number = 1) {
  return {.world = "w1",
          .robot = robot,
          .sequence_number = sequence_number,
          .reason = reason,
          .value_lost_per_s = value_lost_per_s};
}

inline Guidance PathFor(const std::string& robot, std::uint64_t answers_snapshot = 0) {
  return {.world = "w1",
          .robot = robot,
          .revision = 1,
          .path = {{1, 1}},
          .answers_snapshot = answers_snapshot};
}

/// A queue with robots r1, r2, r3 that had their first paths, and interaction times of the prior.
struct QueueBench {
  explicit QueueBench(const AttentionOptions& options = {})
      : queue(options), times(options.priors) {
    for (const char* robot : {"r1", "r2", "r3"}) {
      queue.Receive(WorkingRobot(robot), At(0));
      queue.Receive(PathFor(robot), At(0));
    }
    queue.TakeArrivals();
    queue.TakeDepartures();
  }

  /// Robots in order.
  std::vector<std::string> Order(double now_s) {
    queue.Update(times, At(now_s));
    std::vector<std::string> robots;
    for (const AttentionItem& item : queue.items()) robots.push_back(item.robot);
    return robots;
  }

  AttentionQueue queue;
  InteractionTimes times;
};

}  // namespace conav::operators
