#pragma once

#include <arpa/inet.h>
#include <linux/if_packet.h>
#include <net/ethernet.h>
#include <net/if.h>
#include <netinet/ip.h>
#include <netinet/udp.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <atomic>
#include <cstring>
#include <string>
#include <thread>
#include <vector>

namespace conav::test {

/// One datagram on the loopback interface.
struct Datagram {
  sockaddr_in to{};
  std::string payload;
};

/// Takes all UDP datagrams of the loopback interface from its construction to Stop(). Needs CAP_NET_RAW.
class Sniffer {
 public:
  Sniffer() : socket_(::socket(AF_PACKET, SOCK_DGRAM | SOCK_CLOEXEC, htons(ETH_P_IP))) {
    if (!allowed()) return;
    sockaddr_ll address{};
    address.sll_family = AF_PACKET;
    address.sll_protocol = htons(ETH_P_IP);
    address.sll_ifindex = static_cast<int>(if_nametoindex("lo"));
    bind(socket_, reinterpret_cast<sockaddr*>(&address), sizeof address);
    const int bytes = 64 << 20;
    setsockopt(socket_, SOL_SOCKET, SO_RCVBUFFORCE, &bytes, sizeof bytes);
    thread_ = std::thread([this] { Run(); });
  }
  ~Sniffer() {
    Stop();
    if (allowed()) close(socket_);
  }
  Sniffer(const Sniffer&) = delete;
  Sniffer& operator=(const Sniffer&) = delete;

  bool allowed() const { return socket_ >= 0; }

  const std::vector<Datagram>& Stop() {
    stopping_ = true;
    if (thread_.joinable()) thread_.join();
    return datagrams_;
  }
  /// How many datagrams contain `text`; Stop() first.
  int CountWith(const std::string& text) const {
    int count = 0;
    for (const Datagram& datagram : datagrams_) {
      if (datagram.payload.find(text) != std::string::npos) ++count;
    }
    return count;
  }

 private:
  void Run() {
    std::string packet(1 << 16, '\0');
    while (!stopping_) {
      pollfd ready{socket_, POLLIN, 0};
      if (poll(&ready, 1, 20) <= 0) continue;
      sockaddr_ll from{};
      socklen_t size = sizeof from;
      const auto length = recvfrom(socket_, packet.data(), packet.size(), 0,
                                   reinterpret_cast<sockaddr*>(&from), &size);
      // The interface shows each packet twice, as it goes out and as it comes in.
      if (length > 0 && from.sll_pkttype != PACKET_OUTGOING) {
        Keep(packet.substr(0, static_cast<std::size_t>(length)));
      }
    }
  }
  void Keep(const std::string& packet) {
    iphdr ip{};
    if (packet.size() < sizeof ip) return;
    std::memcpy(&ip, packet.data(), sizeof ip);
    const std::size_t header = ip.ihl * std::size_t{4};
    udphdr udp{};
    if (ip.protocol != IPPROTO_UDP || packet.size() < header + sizeof udp) return;
    std::memcpy(&udp, packet.data() + header, sizeof udp);
    Datagram datagram;
    datagram.to.sin_family = AF_INET;
    datagram.to.sin_addr.s_addr = ip.daddr;
    datagram.to.sin_port = udp.dest;
    datagram.payload = packet.substr(header + sizeof udp);
    datagrams_.push_back(std::move(datagram));
  }

  const int socket_;
  std::atomic<bool> stopping_{false};
  std::vector<Datagram> datagrams_;  // of the thread until Stop()
  std::thread thread_;
};

}  // namespace conav::test
