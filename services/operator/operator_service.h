#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/bus/publisher.h"
#include "common/bus/subscriber.h"
#include "common/msg/robot.h"
#include "common/runtime/clock.h"
#include "common/runtime/threads.h"
#include "common/service/diagnostics.h"
#include "operator/belief/belief_store.h"
#include "operator/config.h"
#include "operator/console/console_topics.h"
#include "operator/foxglove/foxglove_topics.h"
#include "operator/recording/segment_topics.h"
#include "operator/supervision/field_goal_topics.h"
#include "operator/supervision/ros_services.h"
#include "operator/supervision/supervision_topics.h"
#include "operator/world_topics.h"

// One user: main starts it; tests build it whole.

namespace conav::operators {

/// Owns the belief of each world and the guidance of each robot, and answers the requests of all
/// clients, one after the other.
///
/// Serves a world from the moment that the simulator's initial map arrives. A world that is not in
/// the database gets revision 0; of one that is, the stored belief and guidance are published, both
/// latched. Until then its requests wait: those of the bus for their repeat, those of pages here
/// until they expire. An initial map that differs from the stored one is refused: nothing is
/// published for that world, its requests are refused with that reason, and /diagnostics shows an
/// error. A change is on disk before it is published, and published before it is acknowledged. A
/// repeated request gets the answer of the first time, however late it comes and whichever client
/// has control by then.
///
/// Simulation time of a world is the newest stamp of its robots' states; until the first one it is
/// 0. Guidance for a robot that never reported is refused. A robot that has sent fewer pictures
/// than its stored guidance answers belongs to a new run: that guidance is withdrawn. When the disk
/// fails, requests are refused with that reason, /diagnostics shows an error, and the service goes
/// on. Keeps the operator's attention queue (AttentionTopics), and the goals of
/// robots in the field (FieldGoalTopics). Passes low-level actions on to the
/// planner at once (DriveGate); they are not stored. A picture's pixels are moved from the decoded
/// message to the store that answers pages, or, without a console, to the recording; with both, the
/// recording gets the only copy. With `recording.file` it also receives true maps and records the
/// session. With `task.kind` a participant goes through a step of the mapping task or a
/// study here (TaskTopics). With `console.port` it serves the console's page and answers its requests like all
/// others; with `foxglove.port` the clients of Foxglove's protocol (FoxgloveTopics).
/// Threads: one; Run() or repeated Step().
class OperatorService {
 public:
  /// `participant` and `clock` outlive the service. Throws StartupError: the database cannot be
  /// used, the list of robots is wrong.
  OperatorService(bus::Participant& participant, const OperatorConfig& config, const Clock& clock);
  ~OperatorService();

  /// Blocks until `stop`.
  void Run(const StopToken& stop);
  /// Handles everything that arrived so far. Blocks on the disk only.
  void Step();
  /// Address of the console's page; empty without one.
  std::string console_url() const { return console_ ? console_->url() : std::string(); }
  /// The same for Foxglove.
  std::string foxglove_url() const { return foxglove_ ? foxglove_->url() : std::string(); }

 private:
  struct RobotLink;

  /// Publishes its belief and guidance from now on.
  void Serve(WorldTopics& world, const MapUpdate& initial_map);
  /// Publishes nothing of it any longer; subscribers keep what they have.
  void StopServing(WorldTopics& world, std::string reason);
  void PublishBelief(WorldTopics& world);
  void PublishGuidance(RobotLink& robot);
  void ReceiveInitialMap(WorldTopics& world);
  void ReceiveClock();
  void ReceiveStates(RobotLink& robot);
  /// Whether its cells are those of its world's map. Where not, nothing but its stop is known here.
  bool HasUsableMap(RobotLink& robot, const RobotState& state) const;
  /// What the robot asks, and whether it and its planner are still connected.
  void ReceiveAttention(RobotLink& robot);
  void ReceiveSnapshots(RobotLink& robot);
  /// Withdraws guidance that belongs to an earlier run. `state`: the first one of a run.
  void CheckGuidance(RobotLink& robot, const RobotState& state);
  void AnswerClients();
  /// Those of pages, Foxglove and ROS 2 services.
  void AnswerPages();
  /// A repeat gets its first reply. Anything else is refused or carried out. Nothing: no reply yet,
  /// the world is not served. `refusal`: the console's, empty = none.
  /// `replaced_by`: a newer low-level action that arrived in the same step; null when there is
  /// none.
  std::optional<OperatorReply> Answer(const OperatorRequest& request, std::string refusal,
                                      const OperatorRequest* replaced_by);
  BeliefStore::Answer Decide(const OperatorRequest& request);
  OperatorReply HandleDrive(const OperatorRequest& request);
  /// What participant and experimenter ask for, and what follows from it.
  void ServeTask();
  /// The belief or guidance that `request` changed, to robots, pages and the recording.
  void PublishChange(const OperatorRequest& request);
  /// The decision, to logs, the bus and pages.
  OperatorReply Publish(const OperatorRequest& request, const BeliefStore::Answer& answer);
  void UpdateStorageFailure(const BeliefStore::Answer& answer);
  /// A few times a second: alerts, the health of the processes, readiness.
  void UpdateHealth();
  void UpdateConsole();
  /// Forgets, a few at a time, requests that no client repeats any longer.
  void ForgetOldRequests();
  SimTime TimeOf(const std::string& world) const;
  /// Newest simulation time of all worlds, by their robots or by /clock, which is finer.
  SimTime OperatorTime() const;
  Health Report() const;

  bus::Participant& participant_;
  const Clock& clock_;
  BeliefStore store_;
  ControlTopics control_;
  DriveGate drive_gate_;
  std::vector<std::unique_ptr<WorldTopics>> worlds_;
  std::vector<std::unique_ptr<RobotLink>> robots_;
  RequestTopics requests_;
  bus::Publisher<conav_msgs::msg::OperatorReply> replies_;
  bus::Publisher<conav_msgs::msg::OperatorEvent> events_;
  bus::Subscriber<rosgraph_msgs::msg::Clock> clock_topic_;
  SimTime newest_clock_;
  AttentionTopics attention_;
  ServiceMonitor services_;
  FieldGoalTopics goals_;
  AlertTopics alerts_;
  RosServices ros_services_;
  Clock::TimePoint health_due_at_{};
  Clock::TimePoint forget_due_at_{};
  Diagnostics diagnostics_;
  std::optional<SegmentTopics> segments_;
  std::optional<TaskTopics> task_;
  std::optional<ConsoleTopics> console_;
  std::optional<foxglove::FoxgloveTopics> foxglove_;
  std::uint64_t attention_shown_ = 0;          // revision of the queue
  std::uint64_t control_shown_ = 0;            // version
  std::vector<ConsoleTopics::Asked> waiting_;  // for their world; oldest first
  RequestLog request_log_;
  /// Of the newest write; empty = it succeeded, nothing = the disk was not written to yet.
  std::optional<std::string> storage_failure_;
};

}  // namespace conav::operators
