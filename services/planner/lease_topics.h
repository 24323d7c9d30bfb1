#pragma once

#include <atomic>
#include <cstdint>
#include <map>
#include <memory>
#include <string>

#include "common/bus/publisher.h"
#include "common/bus/subscriber.h"
#include "common/runtime/clock.h"
#include "planner/config.h"
#include "planner/decision/blackboard.h"
#include "planner/decision/leases.h"

// One user: the service; apart because it knows the bus.

namespace conav::planner {

/// Shares the robots of this planner process with the others in the domain (lease/lease_desk.h):
/// announces on /conav/planner/lease, hears the others there, and tells the blackboard which robots
/// this process may command; the ways that robots want pass between processes on /<robot>/intended_path.
///
/// Publishes an announcement at once, then every `lease.period_s`. A process that is told to stop
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
  /// Takes what the others said and does what follows from it.
  void Turn();
  /// Gives everything up, when no worker decides any more.
  void Leave();

  /// For the load that the others see.
  void CountDecision(double duration_ms);
  void PublishIntendedPath(const IntendedPath& way);

  /// "lease epoch 3" / "driven by planner-2" / "driven by nobody that is heard", for /diagnostics.
  std::string Describe(const std::string& robot) const;
  int held() const;
  int live_planners() const { return desk_.live_planners(); }

 private:
  struct Way;  // the topics of one robot

  void TakeReleases();
  void Apply(const LeaseTable::Changes& changes);
  void Announce(PlannerLease lease, Clock::TimePoint now);

  Blackboard& board_;
  const Clock& clock_;
  LeaseTable desk_;
  bus::Publisher<conav_msgs::msg::PlannerLease> announcements_;
  bus::Subscriber<conav_msgs::msg::PlannerLease> others_;
  std::map<std::string, std::unique_ptr<Way>> ways_;  // by robot
  std::atomic<std::int64_t> decided_us_ = 0;          // since the last announcement
  Clock::TimePoint announced_at_;
};

}  // namespace conav::planner
