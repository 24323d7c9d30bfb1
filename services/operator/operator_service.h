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
#include "operator/console/task_topics.h"
#include "operator/recording/segment_topics.h"
#include "operator/supervision/alert_topics.h"
#include "operator/supervision/attention_topics.h"
#include "operator/supervision/control_topics.h"
#include "operator/supervision/drive_gate.h"
#include "operator/supervision/request_log.h"

namespace conav::operators {

/// Owns the belief of each world and the guidance of each robot, and answers the requests of all
/// clients, one after the other.
///
/// Serves a world from the moment that the simulator's initial map arrives: a world that is not in
/// the database gets revision 0, of one that is the stored belief and guidance are published, both
/// latched. Until then its requests wait: those of the bus for their repeat, those of pages here,
/// until they are not valid any more. Another initial map than the stored one
/// is refused: then nothing is published for that world, its requests are refused with that reason,
/// and /diagnostics shows an error. A change is on disk before it is published, and published
/// before it is acknowledged. A request that was answered before gets that answer again, whoever
/// has control by now and however late it comes.
///
/// Simulation time of a world is the newest stamp of its robots' states; until the first one it is
/// 0. Guidance for a robot that never reported is refused. A robot that has sent fewer pictures
/// than its stored guidance answers belongs to a new run: that guidance is withdrawn. When the disk
/// fails, requests are refused with that reason, /diagnostics shows an error, and the service goes
/// on. Keeps the queue of what asks for the operator (AttentionTopics). Low-level actions are passed
/// on to the planner at once, see DriveGate; they are not stored. With `recording.file` it also
/// hears pictures and true maps, and records the session. With `task.kind` a participant goes through
/// a maze of the mapping task here (TaskTopics). With
/// `console.port` it serves the console's page, whose requests are answered like all others.
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

 private:
  struct WorldLink;
  struct RobotLink;

  void Serve(WorldLink& world, double cell_size_m);
  /// Publishes nothing for it any more; who has heard of it keeps what it has.
  void Withhold(WorldLink& world, std::string reason);
  WorldLink* FindWorld(const std::string& name);
  void PublishBelief(WorldLink& world);
  void PublishGuidance(RobotLink& robot);
  void TakeInitialMap(WorldLink& world);
  void TakeClock();
  void TakeStates(RobotLink& robot);
  /// What the robot asks, and whether it and its planner are still there.
  void TakeAttention(RobotLink& robot);
  void Greet(RobotLink& robot, const RobotState& state);
  /// The reply of the first time to a repeat. Otherwise carries out what can be carried out.
  /// Nothing: no reply yet, the world is not served. `why_not`: the console's, empty = none.
  /// `replaced_by`: a newer low-level action of the same turn; null when there is none.
  std::optional<OperatorReply> Answer(const OperatorRequest& request, std::string_view why_not,
                                      const OperatorRequest* replaced_by);
  OperatorReply Decide(const OperatorRequest& request, const OperatorRequest* replaced_by);
  OperatorReply PassOn(const OperatorRequest& request, const OperatorRequest* replaced_by);
  void AnswerBus();
  void AnswerConsole();
  void ShowOnConsole();
  /// A few times a second: what is wrong, and how the processes are.
  void LookAround();
  std::vector<RobotCondition> RobotConditions() const;
  /// Forgets, a little at a time, what nobody will ask for any more.
  void TidyUp();
  void PublishChange(const OperatorRequest& request);
  void Record(const OperatorRequest& request);
  BeliefStore::Answer Finish(const OperatorRequest& request);
  void FollowTask();
  /// What was decided, to all who shall know of it.
  OperatorReply Publish(const OperatorRequest& request, const BeliefStore::Answer& answer);
  void NoteStorage(const BeliefStore::Answer& answer);
  SimTime TimeOf(const std::string& world) const;
  /// Newest simulation time of all worlds, by their robots or by /clock, which is finer.
  SimTime OperatorTime() const;
  Health Report() const;

  bus::Participant& participant_;
  const Clock& clock_;
  BeliefStore store_;
  ControlTopics control_;
  DriveGate drive_gate_;
  std::vector<std::unique_ptr<WorldLink>> worlds_;
  std::vector<std::unique_ptr<RobotLink>> robots_;
  bus::Subscriber<conav_msgs::msg::OperatorRequest> requests_;
  bus::Publisher<conav_msgs::msg::OperatorReply> replies_;
  bus::Subscriber<rosgraph_msgs::msg::Clock> clock_topic_;
  SimTime newest_clock_;
  AttentionTopics attention_;
  ServiceMonitor services_;
  AlertTopics alerts_;
  Clock::TimePoint look_around_at_{};
  Clock::TimePoint tidy_up_at_{};
  Diagnostics diagnostics_;
  std::optional<SegmentTopics> segments_;
  std::optional<TaskTopics> task_;
  std::optional<ConsoleTopics> console_;
  std::uint64_t attention_shown_ = 0;  // revision of the queue
  std::uint64_t control_shown_ = 0;    // version
  std::optional<TaskStatus> task_shown_;
  std::vector<ConsoleTopics::Asked> waiting_;  // for their world; oldest first
  RequestLog journal_;
  /// Until something is stored again; empty = the disk is well, nothing = it was not written to yet.
  std::optional<std::string> storage_failure_;
};

}  // namespace conav::operators
