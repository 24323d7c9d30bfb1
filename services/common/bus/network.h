#pragma once

#include <string>
#include <vector>

#include "common/bus/participant.h"

namespace conav::bus {

/// Participants of one domain on one host that find each other without multicast. RTPS gives each a
/// port pair; with 61 of them domain 232 still ends below port 65536.
inline constexpr int kHighestParticipantIndex = 60;

/// Where a participant listens and whom it looks for, in addresses that both vendors take.
struct Network {
  std::string interface_name;     // empty = the vendor's choice
  std::string interface_address;  // IPv4, of interface_name
  bool loopback = false;
  bool multicast = true;
  /// IPv4. With multicast off these and this machine's own, so that processes on one host meet.
  std::vector<std::string> peers;
};

/// Throws StartupError: no such interface (lists those that exist), a peer without IPv4 address.
Network ResolveNetwork(const ParticipantOptions& options);

/// DDS name of a ROS topic: "/r1/state" is "rt/r1/state"; a name without slash stays.
std::string DdsTopicName(const std::string& topic);

}  // namespace conav::bus
