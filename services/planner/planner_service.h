#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/bus/publisher.h"
#include "common/bus/subscriber.h"
#include "common/runtime/clock.h"
#include "common/runtime/stop_token.h"
#include "common/service/diagnostics.h"
#include "planner/config.h"
#include "planner/decision/belief_estimate.h"
#include "planner/decision/blackboard.h"
#include "planner/decision/robot_worker.h"
#include "planner/decision_recording.h"
#include "planner/perception_setup.h"
#include "planner/robot_leases.h"

namespace conav::planner {

/// Drives its robots: one worker thread per robot decides, one thread receives. Robots that other
/// planner processes list, too, are shared with them (robot_leases.h).
///
/// Publishes nothing before the first state of a robot, its map and its world's belief arrived;
/// then command, search report and plan per decision, and an attention request where a method needs
/// the operator.
class PlannerService {
 public:
  /// `participant` and `clock` outlive the service. Throws StartupError on a bad list of robots, or
  /// when decisions shall be recorded and cannot.
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
  std::vector<std::unique_ptr<Link>> links_;
  std::vector<std::unique_ptr<bus::Subscriber<conav_msgs::msg::BeliefMap>>> beliefs_;
  /// By world; in the mapping task only.
  std::map<std::string, bus::Subscriber<nav_msgs::msg::OccupancyGrid>> truths_;
  Diagnostics diagnostics_;
  std::vector<std::unique_ptr<RobotWorker>> workers_;
};

}  // namespace conav::planner
