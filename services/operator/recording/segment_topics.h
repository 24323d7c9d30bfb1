#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <utility>

#include "common/bus/participant.h"
#include "common/bus/subscriber.h"
#include "common/runtime/clock.h"
#include "common/runtime/log.h"
#include "common/segments/segment_log.h"
#include "common/service/diagnostics.h"
#include "operator/recording/segment_collector.h"

// One user: the service; apart because it knows the bus.

namespace conav::operators {

/// Records the sessions of the operator service: receives pictures, true maps, edits and guidance,
/// and appends each completed segment to the file at once, so that a kill loses none.
///
/// A segment that cannot be written is lost, logged and counted; one whose picture cannot be
/// written is recorded without it, which is logged and counted, too. The service goes on.
/// Threads: one, the service's.
class SegmentTopics {
 public:
  /// `participant` and `clock` outlive it. `world_of_robot`: robots and worlds that are recorded.
  /// Throws StartupError: the file cannot be recorded to, the list of mazes is wrong.
  SegmentTopics(bus::Participant& participant, const SegmentOptions& config,
                const std::map<std::string, std::string>& world_of_robot, const Clock& clock);
  /// Records what is left of the session.
  ~SegmentTopics();

  /// Receives true maps. Pictures and this come before requests are answered.
  void Step();
  void Begin(const Belief& belief) { collector_.Begin(belief, clock_.Now()); }
  void Skip(const std::string& robot, std::uint64_t answered) { collector_.Skip(robot, answered); }
  void Receive(const RobotState& state) { collector_.Receive(state); }
  void Receive(Snapshot snapshot) { collector_.Receive(std::move(snapshot), clock_.Now()); }
  void Edited(const Belief& belief);
  void Guided(const Guidance& guidance);
  /// The person says that they are done.
  void Finish();

  /// How many were recorded and lost.
  void AddTo(Health& health) const;

 private:
  void Write();
  Result<void> Append(RecordedSegment& done);
  Result<void> KeepSnapshot(RecordedSegment& done) const;
  void NoteLostSnapshot(const RecordedSegment& done, const Error& why);

  SegmentOptions config_;
  std::string session_;
  const Clock& clock_;
  SegmentCollector collector_;
  SegmentLog log_;
  std::map<std::string, std::uint32_t> numbers_;  // of each world's trajectory in the file
  std::map<std::string, std::unique_ptr<bus::Subscriber<nav_msgs::msg::OccupancyGrid>>>
      truths_;  // by world
  std::uint64_t recorded_ = 0;
  std::uint64_t lost_ = 0;
  std::uint64_t lost_snapshots_ = 0;
  LogLimit failures_logged_;
  LogLimit snapshots_logged_;
};

}  // namespace conav::operators
