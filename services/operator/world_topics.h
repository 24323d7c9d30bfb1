#pragma once

#include <optional>
#include <string>

#include "common/bus/changes.h"
#include "common/bus/participant.h"
#include "common/bus/publisher.h"
#include "common/bus/subscriber.h"
#include "common/grid/geometry.h"
#include "common/msg/robot.h"
#include "common/msg/supervision.h"

// One user: the operator service; why it is apart: a world begins, and may be refused, by itself.

namespace conav::operators {

/// The topics of one world: takes its initial map, and publishes its belief while it is served.
/// Publishes nothing before Serve(). Threads: one, the service's.
class WorldTopics {
 public:
  /// `participant` outlives it.
  WorldTopics(bus::Participant& participant, const std::string& name);

  /// The newest initial map that was neither served nor refused yet. Valid until the next call.
  const MapUpdate* TakeInitialMap();
  /// Publishes the belief from now on; the pending map becomes the initial one.
  void Serve();
  /// Publishes nothing any longer; subscribers keep what they have. `reason`: for people.
  void Refuse(std::string reason);
  /// Does nothing while the world is not served.
  void Publish(const Belief& belief);
  /// Why a robot with this map cannot be shown on the world's; empty = it can, or no map is served.
  std::string CheckAligned(const std::string& robot, const GridGeometry& map) const;

  bool served() const { return belief_.has_value(); }
  /// While it is served.
  const BeliefGrid& initial() const { return initial_; }
  /// Why the newest initial map is not served; empty otherwise.
  const std::string& refusal() const { return refusal_; }

  const std::string name;

 private:
  bus::Participant& participant_;
  bus::Subscriber<nav_msgs::msg::OccupancyGrid> initial_map_;
  std::optional<bus::ChangesPublisher<conav_msgs::msg::BeliefMap>> belief_;  // while it is served
  std::optional<bus::Publisher<nav_msgs::msg::OccupancyGrid>> belief_map_;
  GridGeometry grid_;
  BeliefGrid initial_;
  std::optional<MapUpdate> pending_;
  std::string refusal_;
};

}  // namespace conav::operators
