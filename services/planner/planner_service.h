#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "common/bus/changes.h"
#include "common/bus/participant.h"
#include "common/bus/publisher.h"
#include "common/bus/subscriber.h"
#include "common/msg/perception_model.h"
#include "common/runtime/clock.h"
#include "common/runtime/log.h"
#include "common/runtime/threads.h"
#include "common/service/diagnostics.h"
#include "planner/config.h"
#include "planner/decision/blackboard.h"
#include "planner/decision/leases.h"
#include "planner/decision/method.h"
#include "planner/decision/robot_worker.h"
#include "planner/explain/decision_file.h"
#include "planner/methods/operator_model.h"

// One user: main starts it; tests build it whole.

namespace conav::planner {

/// Records the decisions of a planner's robots for `conav explain`. One that cannot be written is
/// lost, logged and counted; the robots go on.
/// Threads: any.
class DecisionRecording {
 public:
  /// Throws StartupError: the file cannot be recorded to.
  explicit DecisionRecording(const std::filesystem::path& file);

  /// `decision` commands the robot and its report is complete. Blocks on the disk.
  void Record(const Decision& decision, const Situation& situation);

  std::uint64_t recorded() const { return recorded_; }
  std::uint64_t lost() const { return lost_; }

 private:
  std::mutex mutex_;  // guards log_
  DecisionLog log_;
  std::atomic<std::uint64_t> recorded_ = 0;
  std::atomic<std::uint64_t> lost_ = 0;
  LogLimit failures_logged_;
};

/// The perception models of a planner, as its config asks for: the nhpm service or a model in this
/// process, with the embedded GLPF to fall back on.
class PerceptionSetup {
 public:
  /// `participant` and `clock` outlive it. Throws StartupError when the embedded model's weights
  /// cannot be read.
  PerceptionSetup(bus::Participant& participant, const PlannerConfig& config, const Clock& clock);

  /// For the robots of one world. Each world has its own memory of answers and its own state of
  /// fallback, because maps of different worlds may differ in size and a network may be made for
  /// one. Falling back and coming back are logged, with `world`.
  std::shared_ptr<PerceptionModel> ForWorld(const std::string& world) const;

 private:
  const Clock& clock_;
  bool needs_fallback_;
  std::shared_ptr<PerceptionModel> primary_;
  std::size_t cache_bytes_;
  bool pools_;  // that one and a GLPF, world by world
  std::shared_ptr<PerceptionModel> glpf_;
};

/// Shares the robots of this planner process with the others in the domain (decision/leases.h):
/// publishes its lease on /conav/planner/lease, receives those of the others, and puts on the
/// blackboard which robots this process may command; intended paths pass between processes on
/// /<robot>/intended_path.
///
/// Publishes an announcement at once, then every `lease.period_s`. When it stops it
/// says so, and the others take over at once.
/// Threads: Turn() and Receive() on the receiving thread; CountDecision() and PublishIntendedPath() on any.
class RobotLeases {
 public:
  /// `world_of_robot` as the board's. Until a robot is taken, the board has no lease for it.
  RobotLeases(bus::Participant& participant, const PlannerConfig& config,
              const std::map<std::string, std::string>& world_of_robot, Blackboard& board,
              const Clock& clock);
  ~RobotLeases();

  void Receive(const RobotState& state);
  /// Receives the leases and intended paths of the others, and acts on them.
  void Turn();
  /// Gives everything up, when no worker decides any more.
  void Leave();

  /// Of any kind; for the load that the others see.
  void CountDecision(double duration_ms);
  void PublishIntendedPath(const IntendedPath& path);

  /// "lease epoch 3" / "driven by planner-2" / "driven by no live planner", for /diagnostics.
  std::string Describe(const std::string& robot) const;
  int held() const;
  std::uint64_t decisions() const { return decisions_; }
  int live_planners() const { return table_.live_planners(); }

 private:
  struct PathTopics;  // the topics of one robot

  void TakeReleases();
  void Apply(const LeaseTable::Changes& changes);
  void Announce(PlannerLease lease, Clock::TimePoint now);

  Blackboard& board_;
  const Clock& clock_;
  LeaseTable table_;
  bus::Publisher<conav_msgs::msg::PlannerLease> announcements_;
  bus::Subscriber<conav_msgs::msg::PlannerLease> others_;
  std::map<std::string, std::unique_ptr<PathTopics>> paths_;  // by robot
  std::atomic<std::int64_t> decided_us_ = 0;                  // since the last announcement
  std::atomic<std::uint64_t> decisions_ = 0;
  Clock::TimePoint announced_at_;
  LogLimit refusals_logged_;
};

/// Drives its robots: one worker thread per robot decides, one thread receives. Robots that other
/// planner processes list, too, are shared with them (RobotLeases).
///
/// Publishes nothing before the first state of a robot, its map and its world's belief arrived;
/// then command, search report and plan per decision, and an attention request where a method needs
/// the operator.
class PlannerService {
 public:
  /// `participant` and `clock` outlive the service. Throws StartupError on a bad list of robots, or
  /// when the decision file cannot be written.
  PlannerService(bus::Participant& participant, const PlannerConfig& config, const Clock& clock);
  ~PlannerService();

  /// Blocks until `stop`, then ends the workers.
  void Run(const StopToken& stop);

 private:
  struct Link;  // the topics of one robot
  struct PerceptionOfWorld {
    std::shared_ptr<PerceptionModel> model;
    std::shared_ptr<BeliefEstimate> estimate;  // null = the published belief is believed
  };

  PerceptionOfWorld MakePerceptionOfWorld(const std::string& world) const;
  void Receive();
  RobotWorker::Outputs OutputsOf(Link& link);
  Health Report() const;

  bus::Participant& participant_;
  PlannerConfig config_;
  Blackboard board_;
  PerceptionSetup perception_;
  RobotLeases leases_;
  std::optional<DecisionRecording> recording_;
  std::map<std::string, std::shared_ptr<PerceptionModel>> models_;  // by world
  std::vector<std::unique_ptr<Link>> links_;
  std::vector<std::unique_ptr<bus::ChangesSubscriber<conav_msgs::msg::BeliefMap>>> beliefs_;
  /// By world; in the mapping task only.
  std::map<std::string, bus::Subscriber<nav_msgs::msg::OccupancyGrid>> truths_;
  Diagnostics diagnostics_;
  std::vector<std::unique_ptr<RobotWorker>> workers_;
};

}  // namespace conav::planner
