#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/bus/changes.h"
#include "common/bus/subscriber.h"
#include "common/runtime/clock.h"
#include "common/runtime/threads.h"
#include "common/service/diagnostics.h"
#include "operator/simulated/config.h"
#include "operator/simulated/operator_client.h"
#include "operator/simulated/synthetic_operator.h"
#include "operator/simulated/synthetic_teleoperator.h"

// One user: main starts it; tests build it whole.

namespace conav::operators {

/// A synthetic person as a client of the operator service: receives what a console would show, and
/// asks through the same client API, by paths and edits or, as a teleoperator, by keys and edits.
///
/// With person.order "queue" the operator service's attention queue says what comes next. Publishes
/// nothing before a robot's state and its world's belief arrived, and while all its robots are
/// stopped; then requests, one at a time. When the operator service does not answer, it repeats,
/// gives the item up after person.attempts deadlines, and says so in /diagnostics. A teleoperator
/// begins when state and map are there for each robot.
/// Threads: one; Run() or repeated Step().
class SimulatedOperatorService {
 public:
  /// `participant` and `clock` outlive the service. Throws StartupError on a bad list of robots.
  SimulatedOperatorService(bus::Participant& participant, const SimulatedOperatorConfig& config,
                           const Clock& clock);
  ~SimulatedOperatorService();

  /// Blocks until `stop`.
  void Run(const StopToken& stop);
  /// Takes in everything that arrived and asks what is to be asked: nothing while all robots are stopped, after all
  /// goals were reached, and once somebody else has edited a map or given a path. Does not block.
  void Step();

  const SyntheticOperator& person() const { return person_; }

 private:
  struct WorldLink;
  struct RobotLink;

  void TakeIn();
  void TakeInQueue();
  void TakeInGoals(WorldLink& world);
  bool AllStopped() const;
  bool AllGoalsReached() const;
  /// `author`: of a map or a path.
  void StandAsideFor(const std::string& author);
  Health Report() const;
  Health ReportTeleoperation() const;

  bus::Participant& participant_;
  const Clock& clock_;
  SyntheticOperator person_;
  OperatorClient client_;
  std::string name_;  // of this and earlier simulated operators, without what makes them unique
  bool stands_aside_ = false;
  std::optional<SyntheticTeleoperator> teleoperator_;  // with interaction "teleoperation", instead
  std::vector<std::unique_ptr<WorldLink>> worlds_;
  std::vector<std::unique_ptr<RobotLink>> robots_;
  std::optional<bus::Subscriber<conav_msgs::msg::AttentionQueue>> queue_;  // with order "queue"
  std::optional<bus::Subscriber<rosgraph_msgs::msg::Clock>> clock_topic_;  // likewise
  Diagnostics diagnostics_;
};

}  // namespace conav::operators
