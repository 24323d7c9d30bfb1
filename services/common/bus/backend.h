#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "common/bus/participant.h"
#include "common/bus/qos.h"
#include "common/bus/type_support.h"
#include "common/runtime/result.h"

/// The interface between the bus and a DDS vendor. cyclone/, fast/ and the in-memory bus implement
/// it.
namespace conav::bus {

struct EndpointOptions {
  /// ROS name, "/r1/state", which gets the prefix "rt"; a name without slash at its start is DDS's own.
  std::string topic;
  const TypeSupport& type;  // lives as long as the program
  Qos qos;
};

class Writer {
 public:
  virtual ~Writer() = default;
  /// `message` points to the type that the writer was made for. May block briefly when a reliable
  /// queue is full. Where the vendor numbers the requests itself, this sets the number in a request.
  [[nodiscard]] virtual Result<void> Write(const void* message) = 0;
  /// Blocks until every matched reliable reader has acknowledged all samples; false after
  /// `timeout`.
  virtual bool WaitForAcknowledgments(std::chrono::nanoseconds timeout) = 0;
  virtual int matched() const = 0;
  /// Of the matched readers those that are not Demand::kSparse.
  virtual int demanding() const = 0;
};

class Reader {
 public:
  virtual ~Reader() = default;
  virtual int matched() const = 0;
  virtual std::uint64_t malformed() const = 0;
  /// Names the client of a ROS 2 service whose replies this reads.
  virtual Guid client_id() const = 0;
};

/// When a message was published, by the clock of the publisher's host.
using SourceTime = std::chrono::system_clock::time_point;

/// Converts a vendor's source timestamp, ns since 1970. The present if the publisher states none.
inline SourceTime ToSourceTime(std::int64_t nanoseconds) {
  if (nanoseconds <= 0) return std::chrono::system_clock::now();
  return SourceTime(
      std::chrono::duration_cast<SourceTime::duration>(std::chrono::nanoseconds(nanoseconds)));
}

/// Where a message comes from.
struct Origin {
  SourceTime time;
  /// Of DDS; with DDS security its owner's certificate determines the first six bytes.
  Guid writer{};
};

/// So many bytes at the start of their GUIDs do the writers of a participant share.
inline constexpr std::size_t kParticipantBytes = 12;

/// Called on the vendor's receive thread with a decoded message, which the callee may move from.
using Sink = std::function<void(void* message, const Origin& origin)>;

class Backend {
 public:
  virtual ~Backend() = default;
  virtual std::unique_ptr<Writer> CreateWriter(const EndpointOptions& options) = 0;
  virtual std::unique_ptr<Reader> CreateReader(const EndpointOptions& options, Sink sink) = 0;
  virtual std::vector<Event> TakeEvents() = 0;
  virtual bool over_link() const { return false; }
};

/// Fills open fields from the environment (CONAV_DDS, CONAV_DOMAIN then ROS_DOMAIN_ID,
/// CONAV_INTERFACE, CONAV_SYSTEM, ROS_DISTRO, ROS_SECURITY_*) and then from the defaults. As in ROS 2,
/// ROS_SECURITY_STRATEGY=Permissive gives security up, with a warning, where the enclave has no folder;
/// else than there, no strategy is Enforce. Throws StartupError for values that are not allowed.
ParticipantOptions Resolve(ParticipantOptions options);

/// The files of an enclave, as SROS2 lays them out.
struct Enclave {
  std::string name;  // "/conav/host/sim/cyclonedds"
  std::string identity_ca;
  std::string certificate;
  std::string key;
  std::string permissions_ca;
  std::string governance;
  std::string permissions;
  std::string crl;  // empty = none
};

/// That of `options`, which are resolved; none without security. Throws StartupError that names the file
/// that is missing or cannot be read.
std::optional<Enclave> FindEnclave(const ParticipantOptions& options);

/// `options` are resolved. Both throw StartupError when the participant cannot be created.
std::unique_ptr<Backend> MakeCycloneBackend(const std::string& node_name,
                                            const ParticipantOptions& options);
std::unique_ptr<Backend> MakeFastBackend(const std::string& node_name,
                                         const ParticipantOptions& options);

}  // namespace conav::bus
