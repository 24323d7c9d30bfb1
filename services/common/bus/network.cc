#include "common/bus/network.h"

#include <arpa/inet.h>
#include <ifaddrs.h>
#include <net/if.h>
#include <netdb.h>

#include <algorithm>
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

/// Adds the ports of the participants up to that index (RTPS 2.5, 9.6.2.3), once.
void AddPeers(std::vector<Peer>& peers, const std::string& address, int domain_id,
              int highest_index) {
  for (int index = 0; index <= highest_index; ++index) {
    const Peer peer{address, 7400 + 250 * domain_id + 10 + 2 * index};
    if (std::ranges::find(peers, peer) == peers.end()) peers.push_back(peer);
  }
}

}  // namespace

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
    AddPeers(network.peers, own.address, domain_id, kHighestParticipantIndex);
  }
  for (const std::string& peer : options.peers)
    AddPeers(network.peers, ResolvePeer(peer), domain_id, kHighestRemoteIndex);
  return network;
}

std::string ParticipantUserData(const std::string& enclave) { return "enclave=" + enclave + ";"; }

std::string EndpointUserData(const std::string& system, const Qos& qos) {
  std::string data = std::string(kSystemKey) + "=" + system + ";";
  if (qos.demand == Demand::kSparse) data += std::string(kSparseKey) + "=yes;";
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
