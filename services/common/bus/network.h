#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "common/bus/participant.h"
#include "common/bus/qos.h"

namespace conav::bus {

/// Largest participant index of a domain on one host without multicast. RTPS gives each index a
/// port pair; with 61 of them domain 232 still ends below port 65536.
inline constexpr int kHighestParticipantIndex = 60;
/// The same of another host's processes that are looked for: each index costs an announcement per
/// period on the link. Processes with higher ones are found because they announce themselves.
inline constexpr int kHighestRemoteIndex = 3;

/// Where a participant may listen for announcements.
struct Peer {
  std::string address;  // IPv4
  int port = 0;
  bool operator==(const Peer&) const = default;
};

/// Where a participant listens and which peers it contacts, as addresses for both vendors.
struct Network {
  std::string interface_name;     // empty = the vendor's choice
  std::string interface_address;  // IPv4, of interface_name
  bool loopback = false;
  bool multicast = true;
  /// Without multicast. Also on this machine's own addresses, so that processes on one host meet.
  std::vector<Peer> peers;
};

/// Throws StartupError for an unknown interface (lists the known ones) or a peer without IPv4
/// address.
Network ResolveNetwork(const ParticipantOptions& options);

/// The user data of a participant or endpoint is a list "key=value;", as in ROS 2. A participant names its
/// enclave; "/" = it has none.
std::string ParticipantUserData(const std::string& enclave);
/// An endpoint names its system, and a reader of Demand::kSparse says so.
std::string EndpointUserData(const std::string& system, const Qos& qos);
inline constexpr std::string_view kSystemKey = "conav_system";
inline constexpr std::string_view kSparseKey = "conav_sparse";
/// The value of `key` there; empty = it is not there.
std::string_view ValueOf(std::string_view key, std::string_view user_data);

/// DDS name of a ROS topic: "/r1/state" is "rt/r1/state"; a name without slash stays as it is.
std::string DdsTopicName(const std::string& topic);

/// Whether that is the topic on which a ROS 2 service replies: it starts with "rr/".
bool IsReplyTopic(const std::string& topic);

}  // namespace conav::bus
