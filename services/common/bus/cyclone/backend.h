#pragma once

#include <dds/dds.h>

#include <map>
#include <memory>
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

/// A Cyclone DDS domain. There is one per process and domain number, shared by its participants.
class CycloneDomain {
 public:
  /// Opens the domain or returns the open one. Throws StartupError when Cyclone rejects the
  /// configuration, or when the domain is open with a different one.
  static std::shared_ptr<CycloneDomain> Open(int domain_id, const std::string& configuration);

  CycloneDomain(int domain_id, std::string configuration);
  ~CycloneDomain();
  CycloneDomain(const CycloneDomain&) = delete;
  CycloneDomain& operator=(const CycloneDomain&) = delete;

 private:
  std::string configuration_;
  dds_entity_t domain_;
};

/// The state that the endpoints of one participant share. Outlives them.
struct CycloneContext {
  dds_entity_t participant;
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

 private:
  CycloneContext context_;
  EndpointOptions options_;
  EndpointEvents events_;
  CycloneEntity topic_;
  CycloneEntity writer_;
};

class CycloneReader final : public Reader {
 public:
  CycloneReader(const CycloneContext& context, const EndpointOptions& options, Sink sink);
  ~CycloneReader() override;

  int matched() const override;
  std::uint64_t malformed() const override { return intake_.malformed(); }

  /// Called by Cyclone, one call at a time, already before the constructor has the handle.
  void TakeAll(dds_entity_t reader) noexcept;
  EndpointEvents& events() { return events_; }

 private:
  bool IsRepeated(dds_entity_t reader, const dds_sample_info_t& info);
  const Guid& WriterOf(dds_entity_t reader, dds_instance_handle_t publication);

  CycloneContext context_;
  EndpointEvents events_;
  Intake intake_;
  const bool check_repeats_;  // vendors only repeat transient-local history
  Deduplicator deduplicator_;
  std::map<dds_instance_handle_t, Guid> writers_;
  CycloneEntity topic_;
  CycloneEntity reader_;  // last: its callbacks use the other members
};

}  // namespace conav::bus
