#include "common/bus/network.h"

#include <arpa/inet.h>
#include <ifaddrs.h>
#include <net/if.h>
#include <netdb.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <memory>

#include "common/runtime/result.h"

namespace conav::bus {
namespace {

struct Interface {
  std::string name;
  std::string address;
  bool loopback;
};

std::string AddressText(const sockaddr* address) {
  char text[INET_ADDRSTRLEN] = "";
  const auto* ipv4 = reinterpret_cast<const sockaddr_in*>(address);
  inet_ntop(AF_INET, &ipv4->sin_addr, text, sizeof text);
  return text;
}

std::vector<Interface> UsableInterfaces() {
  ifaddrs* list = nullptr;
  if (getifaddrs(&list) != 0) return {};
  const std::unique_ptr<ifaddrs, void (*)(ifaddrs*)> owner(list, freeifaddrs);
  std::vector<Interface> interfaces;
  for (const ifaddrs* entry = list; entry != nullptr; entry = entry->ifa_next) {
    if (entry->ifa_addr == nullptr || entry->ifa_addr->sa_family != AF_INET) continue;
    if ((entry->ifa_flags & IFF_UP) == 0) continue;
    interfaces.push_back(
        {entry->ifa_name, AddressText(entry->ifa_addr), (entry->ifa_flags & IFF_LOOPBACK) != 0});
  }
  return interfaces;
}

Interface FindInterface(const std::vector<Interface>& interfaces, const std::string& wanted) {
  std::string known;
  for (const Interface& candidate : interfaces) {
    if (candidate.name == wanted || candidate.address == wanted) return candidate;
    known += (known.empty() ? "" : ", ") + candidate.name + " " + candidate.address;
  }
  throw StartupError("interface = " + wanted + " is not a network interface of this machine (" +
                     known + ")");
}

/// RTPS 2.5, 9.6.2.3.
int AnnouncementPort(int domain_id, int index) { return FirstPortOf(domain_id) + 10 + 2 * index; }

sockaddr_in ToSocketAddress(const Peer& peer) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(peer.port));
  address.sin_addr.s_addr = htonl(INADDR_ANY);
  if (!peer.address.empty()) inet_pton(AF_INET, peer.address.c_str(), &address.sin_addr);
  return address;
}

/// -1 while another process has it.
int OpenPort(const Peer& port) {
  const int descriptor = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  if (descriptor < 0) return -1;
  const sockaddr_in address = ToSocketAddress(port);
  if (bind(descriptor, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0) {
    return descriptor;
  }
  close(descriptor);
  return -1;
}

}  // namespace

std::string ResolvePeer(const std::string& peer) {
  addrinfo hints{};
  hints.ai_family = AF_INET;
  hints.ai_socktype = SOCK_DGRAM;
  addrinfo* list = nullptr;
  const int error = getaddrinfo(peer.c_str(), nullptr, &hints, &list);
  if (error != 0) {
    throw StartupError("peers: " + peer + " has no IPv4 address (" + gai_strerror(error) + ")");
  }
  const std::unique_ptr<addrinfo, void (*)(addrinfo*)> owner(list, freeaddrinfo);
  return AddressText(list->ai_addr);
}

Network ResolveNetwork(const ParticipantOptions& options) {
  Network network;
  const std::vector<Interface> interfaces = UsableInterfaces();
  if (!options.interface.empty()) {
    const Interface used = FindInterface(interfaces, options.interface);
    network.interface_name = used.name;
    network.interface_address = used.address;
    network.loopback = used.loopback;
  }
  network.multicast = options.peers.empty() && !network.loopback;
  if (network.multicast) return network;
  const int domain_id = std::max(0, options.domain_id);
  for (const Interface& own : interfaces) {
    if (!network.interface_address.empty() && own.address != network.interface_address) continue;
    for (int index = 0; index <= kHighestParticipantIndex; ++index) {
      network.own_ports.push_back({own.address, AnnouncementPort(domain_id, index)});
    }
  }
  for (const std::string& peer : options.peers) {
    const Peer relay{ResolvePeer(peer), AnnouncementPort(domain_id, kRelayIndex)};
    const bool is_own =
        std::ranges::find(interfaces, relay.address, &Interface::address) != interfaces.end();
    const bool is_known =
        std::ranges::find(network.remote_relays, relay) != network.remote_relays.end();
    if (!is_own && !is_known) network.remote_relays.push_back(relay);
  }
  return network;
}

AnnouncementRelay::AnnouncementRelay(const Network& network, int domain_id)
    : port_{network.interface_address, AnnouncementPort(domain_id, kRelayIndex)},
      targets_(network.own_ports) {
  if (network.remote_relays.empty()) return;
  stop_ = eventfd(0, EFD_CLOEXEC);
  if (stop_ < 0) throw StartupError("no eventfd for the relay of announcements");
  thread_ = std::thread([this] { Run(); });
}

AnnouncementRelay::~AnnouncementRelay() {
  if (stop_ < 0) return;
  eventfd_write(stop_, 1);
  thread_.join();
  close(stop_);
}

void AnnouncementRelay::Run() {
  constexpr int kTakeOverMs = 500;
  int port = -1;
  while (true) {
    if (port < 0) port = OpenPort(port_);
    std::array ready{pollfd{stop_, POLLIN, 0}, pollfd{port, POLLIN, 0}};  // poll skips -1
    poll(ready.data(), ready.size(), port < 0 ? kTakeOverMs : -1);
    if (ready[0].revents != 0) break;
    if (ready[1].revents != 0) Forward(port);
  }
  if (port >= 0) close(port);
}

void AnnouncementRelay::Forward(int port) const {
  constexpr std::string_view kMagic = "RTPS";
  std::array<char, 4096> datagram;  // announcements are shorter, with certificates, too
  const ssize_t size = recv(port, datagram.data(), datagram.size(), MSG_TRUNC);
  if (size < 0 || size > static_cast<ssize_t>(datagram.size()) ||
      !std::string_view(datagram.data(), static_cast<std::size_t>(size)).starts_with(kMagic)) {
    return;
  }
  for (const Peer& target : targets_) {
    const sockaddr_in address = ToSocketAddress(target);
    sendto(port, datagram.data(), static_cast<std::size_t>(size), 0,
           reinterpret_cast<const sockaddr*>(&address), sizeof address);
  }
}

std::string ParticipantUserData(const std::string& enclave) { return "enclave=" + enclave + ";"; }

std::string EndpointUserData(const std::string& system, const Qos& qos, bool loopback) {
  std::string data = std::string(kSystemKey) + "=" + system + ";";
  const bool is_sparse =
      qos.demand == Demand::kSparse || (qos.demand == Demand::kSparseOverLinks && !loopback);
  if (is_sparse) data += std::string(kSparseKey) + "=yes;";
  return data;
}

std::string_view ValueOf(std::string_view key, std::string_view user_data) {
  while (!user_data.empty()) {
    const std::string_view pair = user_data.substr(0, user_data.find(';'));
    if (pair.size() > key.size() && pair.starts_with(key) && pair[key.size()] == '=') {
      return pair.substr(key.size() + 1);
    }
    user_data.remove_prefix(std::min(pair.size() + 1, user_data.size()));
  }
  return {};
}

bool IsReplyTopic(const std::string& topic) { return topic.starts_with("rr/"); }

std::string DdsTopicName(const std::string& topic) {
  return topic.starts_with('/') ? "rt" + topic : topic;
}

}  // namespace conav::bus
