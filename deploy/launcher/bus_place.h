#pragma once

#include <list>
#include <memory>
#include <string>
#include <vector>

#include "common/bus/participant.h"
#include "common/bus/subscriber.h"
#include "common/msg/planner_lease.h"
#include "launcher/demo_options.h"
#include "launcher/domain_lease.h"
#include "launcher/run_log.h"

namespace conav::launcher {

/// Listens to a run and folds what it hears into an Episode. Joins late without loss: all of these
/// topics keep their newest messages for late joiners. Publishes nothing.
/// Threads: one.
class Recorder {
 public:
  /// `episode` names the robots and worlds to listen to; it outlives the recorder.
  Recorder(bus::Participant& participant, Episode& episode);

  /// Folds in what arrived since the last call; false when there was no news. Never
  /// blocks.
  bool Take();

  /// The first of the robots that somebody publishes the state of; empty when none.
  std::string published_robot() const;

  /// What planner processes announced since the last call.
  std::vector<PlannerLease> TakeLeases();

 private:
  struct RobotTopics {
    RobotTopics(bus::Participant& participant, RobotRecord& record);
    bool Take();

    RobotRecord& record;
    bus::Subscriber<conav_msgs::msg::RobotState> states;
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

  bus::Subscriber<conav_msgs::msg::PlannerLease> leases_;
  std::list<RobotTopics> robots_;
  std::list<WorldTopics> worlds_;
};

/// The launcher's own place on the bus, in a domain where no other conav publishes its robots.
struct BusPlace {
  DomainLease lease;
  std::unique_ptr<bus::Participant> participant;
  std::unique_ptr<Recorder> recorder;
};

/// The arguments do not fit what is there; main prints it and exits with 2.
class UsageError : public StartupError {
  using StartupError::StartupError;
};

/// How a process of this demo takes part in DDS: with what the environment says where `vendor` or
/// the interface is empty, so that a written configuration means the same everywhere. Throws
/// StartupError when the environment names no DDS vendor.
bus::ParticipantOptions BusOptions(const DemoOptions& options, int domain,
                                   const std::string& vendor);

/// Takes the domain of the options or of the environment (CONAV_DOMAIN); without these the first
/// free one. Listens for a moment for robots of the same name before it is content with a domain.
/// Throws UsageError when the wanted domain is taken (by which robot), StartupError from the bus.
BusPlace JoinFreeDomain(const DemoOptions& options, Episode& episode);

/// The same in a domain that is ours already; nobody is listened for. Throws StartupError from the
/// bus.
BusPlace JoinKeptDomain(const DemoOptions& options, DomainLease lease, Episode& episode);

}  // namespace conav::launcher
