#pragma once

#include <list>
#include <memory>
#include <string>
#include <vector>

#include "common/bus/participant.h"
#include "common/bus/subscriber.h"
#include "common/msg/planner_lease.h"
#include "common/service/node_services.h"
#include "common/service/robot_state_topics.h"
#include "launcher/demo_options.h"
#include "launcher/domain_lease.h"
#include "launcher/run_log.h"

namespace conav::launcher {

/// Listens to a run and folds its messages into an Episode. Joins late without loss: all of these
/// topics keep their newest messages for late joiners. Publishes nothing.
/// Threads: one.
class RunObserver {
 public:
  /// Listens to the robots and worlds of `episode`, which outlives this object.
  RunObserver(bus::Participant& participant, Episode& episode);

  /// Folds in all messages since the last call; false if there were none. Never
  /// blocks.
  bool Take();

  /// The first of the robots whose state another process publishes; empty if none.
  std::string published_robot() const;

  /// The leases of planner processes since the last call.
  std::vector<PlannerLease> TakeLeases();

 private:
  struct RobotTopics {
    RobotTopics(bus::Participant& participant, RobotRecord& record);
    bool Take();

    RobotRecord& record;
    RobotStateTopics states;
    bus::Subscriber<conav_msgs::msg::Snapshot> snapshots;
    bus::Subscriber<conav_msgs::msg::Guidance> guidances;
    bus::Subscriber<conav_msgs::msg::SearchReport> reports;
  };
  struct WorldTopics {
    WorldTopics(bus::Participant& participant, WorldRecord& record);
    bool Take();

    WorldRecord& record;
    bus::Subscriber<conav_msgs::msg::BeliefMap> beliefs;
    bus::Subscriber<nav_msgs::msg::OccupancyGrid> truths;
    bus::Subscriber<nav_msgs::msg::OccupancyGrid> initial_maps;
  };

  Episode& episode_;
  bus::Subscriber<conav_msgs::msg::PlannerLease> leases_;
  bus::Subscriber<conav_msgs::msg::OperatorEvent> events_;
  std::list<RobotTopics> robots_;
  std::list<WorldTopics> worlds_;
};

/// What ROS 2 tools ask of the launcher: it is active and has no parameters.
struct LauncherNode {
  explicit LauncherNode(bus::Participant& participant) : services(participant, {}) {}

  NodeServices services;
  NodeServices::Running running{services, nullptr};
};

/// The launcher's connection to the bus, in a domain without another conav's robots.
struct BusSession {
  DomainLease lease;
  std::unique_ptr<bus::Participant> participant;
  std::unique_ptr<LauncherNode> node;  // null: no distribution of ROS 2 is known
  std::unique_ptr<RunObserver> observer;
};

/// The arguments do not fit the circumstances; main prints it and exits with 2.
class UsageError : public StartupError {
  using StartupError::StartupError;
};

/// How a process of this demo takes part in DDS. Resolves an empty vendor or interface from the
/// environment, so that a written configuration means the same everywhere. Throws StartupError when
/// the environment names an unknown DDS vendor.
bus::ParticipantOptions BusOptions(const DemoOptions& options, int domain,
                                   std::optional<bus::Vendor> vendor);

/// Takes the domain of the options or of the environment (CONAV_DOMAIN), else the first free one.
/// Before it accepts a domain, it listens briefly for robots of the same name. Throws UsageError
/// when the requested domain is taken (names the robot), StartupError from the bus.
BusSession JoinFreeDomain(const DemoOptions& options, Episode& episode);

/// The same in a domain that is already ours; does not listen first. Throws StartupError from the
/// bus.
BusSession JoinKeptDomain(const DemoOptions& options, DomainLease lease, Episode& episode);

}  // namespace conav::launcher
