#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "common/bus/backend.h"
#include "common/bus/intake.h"
#include "common/bus/participant.h"
#include "common/bus/topics.h"

namespace conav::bus {

/// Turns `name` into a ROS 2 node name of letters, digits and underscores: "nhpm-2" becomes nhpm_2.
std::string RosName(std::string name);

/// This host's name as it stands in enclaves, a RosName().
std::string HostName();

/// Shows ROS 2 tools which endpoints belong to this process's node: publishes the complete
/// ros_discovery_info after each change, in the layout of the distribution; none for kNone.
/// Threads: safe to call concurrently.
class RosGraph {
 public:
  RosGraph(const std::string& node_name, RosDistribution distribution, const Guid& participant);

  bool publishes() const { return distribution_ != RosDistribution::kNone; }
  /// Create the writer for Start() with these options. Both only if this publishes.
  EndpointOptions endpoint() const;
  /// Publishes the node, still without endpoints.
  void Start(std::unique_ptr<Writer> writer);

  void AddReader(const Guid& reader) { Change(readers_, reader, true); }
  void RemoveReader(const Guid& reader) { Change(readers_, reader, false); }
  void AddWriter(const Guid& writer) { Change(writers_, writer, true); }
  void RemoveWriter(const Guid& writer) { Change(writers_, writer, false); }

 private:
  void Change(std::vector<Guid>& guids, const Guid& guid, bool add);
  void PublishLocked();
  template <class Message, class Gid, class Node>
  Message MakeMessage() const;

  const std::string node_name_;
  const RosDistribution distribution_;
  const Guid participant_;
  std::mutex mutex_;  // guards what follows
  std::vector<Guid> readers_;
  std::vector<Guid> writers_;
  std::unique_ptr<Writer> writer_;
};

/// ros_discovery_info of any process, in either layout: the CDR payload as it came.
struct RosDiscoveryInfo {
  std::vector<std::uint8_t> payload;
};

template <>
const TypeSupport& TypeSupportOf<RosDiscoveryInfo>();

/// What a foreign process shows of its nodes.
struct RosNodes {
  RosDistribution layout;
  std::vector<std::string> names;  // "/turtlebot/camera"
};

/// None = the payload has neither layout.
std::optional<RosNodes> ParseRosDiscoveryInfo(const RosDiscoveryInfo& info);

/// Of all processes, as ROS 2's own nodes read it.
inline constexpr Topic<RosDiscoveryInfo> kRosDiscoveryInfo{
    "ros_discovery_info", {Reliability::kReliable, Durability::kTransientLocal, 0}, "", ""};

}  // namespace conav::bus
