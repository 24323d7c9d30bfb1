#pragma once

#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "common/bus/backend.h"
#include "common/bus/intake.h"

namespace conav::bus {

/// Turns `name` into a ROS 2 node name of letters, digits and underscores: "nhpm-2" becomes nhpm_2.
std::string RosName(std::string name);

/// Shows ROS 2 tools which endpoints belong to this process's node: publishes the complete
/// ros_discovery_info after each change, in the layout of the distribution.
/// Threads: safe to call concurrently.
class RosGraph {
 public:
  /// `distribution` is "jazzy" (16-byte gids) or "humble" (24).
  RosGraph(const std::string& node_name, const std::string& distribution, const Guid& participant);

  /// Create the writer for Start() with these options.
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
  const bool humble_;
  const Guid participant_;
  std::mutex mutex_;  // guards what follows
  std::vector<Guid> readers_;
  std::vector<Guid> writers_;
  std::unique_ptr<Writer> writer_;
};

}  // namespace conav::bus
