#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/bus/backend.h"
#include "common/bus/participant.h"
#include "common/bus/qos.h"

namespace conav::recorder {

/// A message as plain little-endian CDR with its encapsulation, the stamp of its header in ns, if it
/// has one, and its writer. On a receive thread.
using RawSink = std::function<void(std::vector<std::uint8_t> data,
                                   std::optional<std::uint64_t> stamp, const bus::Guid& writer)>;

/// Thinned: of /clock, odometry and transforms one message per 0.25 s of their time, and the simulator
/// does not publish more for this reader's sake (bus::Demand::kSparse).
enum class Rate { kFull, kThinned };

/// A topic whose messages are passed on as they are, whatever their type.
///
/// A message is decoded as by any other subscriber of the bus, so that a malformed one is dropped,
/// and serialised again: what is passed on can be read. (Fast DDS knows one type of a name in a
/// process, so that payloads cannot be had undecoded where the process also reads the messages.)
struct RawTopic {
  std::string name;            // "/r1/state"
  std::string type;            // "conav_msgs/msg/RobotState"
  std::string_view pattern;    // "/{}/state"
  std::string_view direction;  // "sim -> all"
  bus::Qos qos;
  /// Subscribes; the reader's end unsubscribes. The participant outlives it.
  std::function<std::unique_ptr<bus::Reader>(bus::Participant&, Rate, RawSink)> listen;
};

/// All topics of these "world/robot" entries, which may be none, of their worlds, and of the system.
/// Throws StartupError that names `service` for a wrong entry.
std::vector<RawTopic> RawTopicsOf(const std::string& service,
                                  const std::vector<std::string>& robots);

}  // namespace conav::recorder
