#pragma once

#include <dds/dds.h>

#include <string>

#include "common/bus/backend.h"
#include "common/bus/events.h"
#include "common/bus/intake.h"
#include "common/bus/network.h"
#include "common/bus/ros_graph.h"

namespace conav::bus {

/// Configuration of a Cyclone DDS domain: network, discovery, lease and what interoperation with
/// Fast DDS needs. Ignores the environment variable CYCLONEDDS_URI.
std::string CycloneConfiguration(const Network& network, double lease_s);

/// The state that the endpoints of one participant share. Outlives them.
struct CycloneContext {
  dds_entity_t participant;
  std::string system;
  bool loopback;
  double lease_s;
  EventLog& events;
  RosGraph* graph;  // null for endpoints that ROS tools do not see
};

/// Deletes a Cyclone entity; waits for its callbacks.
class CycloneEntity {
 public:
  /// Throws StartupError naming `what` for an error code.
  CycloneEntity(dds_entity_t handle, const std::string& what);
  ~CycloneEntity() { dds_delete(handle_); }
  CycloneEntity(const CycloneEntity&) = delete;
  CycloneEntity& operator=(const CycloneEntity&) = delete;

  dds_entity_t handle() const { return handle_; }
  Guid guid() const;

 private:
  dds_entity_t handle_;
};

class CycloneWriter final : public Writer {
 public:
  CycloneWriter(const CycloneContext& context, const EndpointOptions& options);
  ~CycloneWriter() override;

  Result<void> Write(const void* message) override;
  bool WaitForAcknowledgments(std::chrono::nanoseconds timeout) override;
  int matched() const override;
  int demanding() const override;

 private:
  CycloneContext context_;
  EndpointOptions options_;
  EndpointEvents events_;
  CycloneEntity topic_;
  CycloneEntity writer_;
};

}  // namespace conav::bus
