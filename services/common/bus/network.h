#pragma once

#include <string>
#include <vector>

#include "common/bus/participant.h"

namespace conav::bus {

/// Largest participant index of a domain on one host without multicast. RTPS gives each index a
/// port pair; with 61 of them domain 232 still ends below port 65536.
inline constexpr int kHighestParticipantIndex = 60;

/// Where a participant listens and which peers it contacts, as addresses for both vendors.
struct Network {
  std::string interface_name;     // empty = the vendor's choice
  std::string interface_address;  // IPv4, of interface_name
  bool loopback = false;
  bool multicast = true;
  /// IPv4. Without multicast, also this machine's own addresses, so that processes on one host
  /// meet.
  std::vector<std::string> peers;
};

/// Throws StartupError for an unknown interface (lists the known ones) or a peer without IPv4
/// address.
Network ResolveNetwork(const ParticipantOptions& options);

/// DDS name of a ROS topic: "/r1/state" is "rt/r1/state"; a name without slash stays as it is.
std::string DdsTopicName(const std::string& topic);

/// Whether that is the topic on which a ROS 2 service replies: it starts with "rr/".
bool IsReplyTopic(const std::string& topic);

}  // namespace conav::bus
