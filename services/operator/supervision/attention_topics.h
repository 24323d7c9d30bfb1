#pragma once

#include <cstdint>
#include <deque>
#include <string>
#include <vector>

#include "common/bus/publisher.h"
#include "common/msg/robot.h"
#include "common/msg/supervision.h"
#include "common/runtime/clock.h"
#include "operator/supervision/attention_queue.h"
#include "operator/supervision/workload.h"

// One user: the service; apart because it knows the bus.

namespace conav::operators {

/// The operator service's attention queue on the bus: keeps it, measures the operator's work on it,
/// publishes both.
///
/// Publishes an empty queue at once; then the queue whenever an item has come, gone or moved, and
/// at least each second (wall time) for the measures. Selections are not stored: they change
/// nothing that has to outlive the service.
/// Threads: one, the service's.
class AttentionTopics {
 public:
  /// `participant` and `clock` outlive it.
  AttentionTopics(bus::Participant& participant, const AttentionOptions& options,
                  const Clock& clock);

  /// `now` is the operator's time throughout: the newest simulation time of all worlds.
  void Receive(const AttentionRequest& request, SimTime now) { queue_.Receive(request, now); }
  void Receive(const RobotState& state, SimTime now) { queue_.Receive(state, now); }
  /// Found in the database or withdrawn by the service itself.
  void Receive(const Guidance& guidance, SimTime now) { queue_.Receive(guidance, now); }
  void LoseLink(const std::string& robot, SimTime now) { queue_.LoseLink(robot, now); }
  void LosePlanner(const std::string& robot, SimTime now) { queue_.LosePlanner(robot, now); }
  /// A request of `client` was accepted.
  void Guided(const std::string& client, const Guidance& guidance, SimTime now);
  void Edited(const std::string& client, const std::string& world, SimTime now);
  /// `request` holds a SelectRequest. A repeat gets the reply of the first time, unless many other
  /// clients selected something meanwhile.
  OperatorReply Select(const OperatorRequest& request, SimTime now);

  /// After everything that one step brought.
  void Step(SimTime now);

  /// As it was published last.
  const AttentionQueueState& published() const { return published_; }
  const std::vector<AttentionItem>& items() const { return queue_.items(); }

 private:
  /// Passes new questions to the meter, before what becomes of them.
  void TakeArrivals(SimTime now);
  void Publish(SimTime now);

  AttentionOptions options_;
  const Clock& clock_;
  AttentionQueue queue_;
  WorkloadMeter meter_;
  std::deque<OperatorReply> newest_selections_;  // one for each client, newest last
  bus::Publisher<conav_msgs::msg::AttentionQueue> publisher_;
  AttentionQueueState published_;
  Clock::TimePoint published_at_{};
};

}  // namespace conav::operators
