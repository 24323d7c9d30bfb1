#pragma once

#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "common/bus/participant.h"
#include "common/bus/qos.h"

namespace conav::bus {

/// Largest participant index of a domain on one host without multicast. RTPS gives each index a
/// port pair; with 61 of them domain 232 still ends below port 65536.
inline constexpr int kHighestParticipantIndex = 60;
/// The index whose port belongs to no participant but to the host's AnnouncementRelay.
inline constexpr int kRelayIndex = kHighestParticipantIndex + 1;

/// The first of a domain's UDP ports (RTPS 2.5, 9.6.2.3).
constexpr int FirstPortOf(int domain_id) { return 7400 + 250 * domain_id; }

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
  /// Without multicast, on this machine's own addresses, so that its processes meet.
  std::vector<Peer> own_ports;
  /// The relays of other hosts.
  std::vector<Peer> remote_relays;

  /// s between two announcements without multicast; on a link they are a good part of all traffic
  /// (docs/reliability.md).
  double announcement_s() const { return loopback ? 1.0 : 1.5; }
};

/// Throws StartupError for an unknown interface (lists the known ones) or a peer without IPv4
/// address.
Network ResolveNetwork(const ParticipantOptions& options);

/// The IPv4 address of a host. Throws StartupError, as ResolveNetwork() does for a peer.
std::string ResolvePeer(const std::string& peer);

/// Passes the announcements that other hosts send to this host's relay port on to the ports of all
/// participants here. One process of a host has the port; when it ends, another one takes over. So a
/// process announces itself once per other host, however many processes run there. An
/// announcement holds its sender's address, so later traffic goes directly. Does nothing without other
/// hosts. Threads: has one of its own.
class AnnouncementRelay {
 public:
  AnnouncementRelay(const Network& network, int domain_id);
  ~AnnouncementRelay();
  AnnouncementRelay(const AnnouncementRelay&) = delete;
  AnnouncementRelay& operator=(const AnnouncementRelay&) = delete;

 private:
  void Run();
  void Forward(int port) const;

  const Peer port_;
  const std::vector<Peer> targets_;
  int stop_ = -1;  // an eventfd
  std::thread thread_;
};

/// The user data of a participant or endpoint is a list "key=value;", as in ROS 2. A participant names its
/// enclave; "/" = it has none.
std::string ParticipantUserData(const std::string& enclave);
/// An endpoint names its system, and a sparse reader (Demand) says so.
std::string EndpointUserData(const std::string& system, const Qos& qos, bool loopback);
inline constexpr std::string_view kSystemKey = "conav_system";
inline constexpr std::string_view kSparseKey = "conav_sparse";
/// The value of `key` there; empty = it is not there.
std::string_view ValueOf(std::string_view key, std::string_view user_data);

/// DDS name of a ROS topic: "/r1/state" is "rt/r1/state"; a name without slash stays as it is.
std::string DdsTopicName(const std::string& topic);

/// Whether that is the topic on which a ROS 2 service replies: it starts with "rr/".
bool IsReplyTopic(const std::string& topic);

}  // namespace conav::bus
