#pragma once

#include <list>
#include <string>
#include <vector>

#include "common/bus/participant.h"
#include "common/bus/subscriber.h"
#include "common/protocol/planner_lease.h"
#include "launcher/episode.h"

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

}  // namespace conav::launcher
