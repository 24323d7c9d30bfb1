#pragma once

#include <netinet/in.h>

#include <array>
#include <chrono>
#include <map>
#include <set>
#include <string>

#include "common/bus/network.h"
#include "common/runtime/clock_offset.h"
#include "launcher/hosts.h"

// One user: the doctor; apart because it talks to the network, not to the bus.

namespace conav::launcher {

/// What a doctor says about its host.
struct HostFacts {
  std::string host;
  std::string version;  // of conav
  std::string plan;     // HostsPlan::checksum()
  /// SHA-256 of the certificate of the keys' authority; empty without security.
  std::string authority;
  bool operator==(const HostFacts&) const = default;
};

/// What was found out about another host.
struct PeerReport {
  /// Why nothing can be sent there, or that no doctor is there; empty = nothing is known.
  std::string problem;
  HostFacts facts;    // with a host's name: its doctor answered, both ways are open
  ClockOffset clock;  // its time of day against ours
  /// Payloads that went there and back in one piece, and in any way.
  std::set<std::size_t> whole;
  std::set<std::size_t> in_pieces;
  bool multicast = false;
};

/// Asks the doctors of other hosts by UDP, and answers theirs: only to hosts of the plan, and never more than was asked.
/// Threads: one.
class HostProbe {
 public:
  /// The bus sends datagrams of this payload, the largest of all sizes that are tried.
  static constexpr std::size_t kBusDatagram = 1400;
  static constexpr std::array<std::size_t, 5> kSizes{548, 1200, 1300, 1372, kBusDatagram};

  /// Among the domain's own ports, behind those of participants and of the relay of announcements.
  static int PortOf(int domain_id) { return bus::FirstPortOf(domain_id) + 135; }

  /// `own` is of the plan; an address that has no IPv4 address is a problem in its report. Throws StartupError: the port is
  /// taken, or the interface is none of this machine's.
  HostProbe(const HostsPlan& plan, HostFacts own, int domain_id);
  ~HostProbe();
  HostProbe(const HostProbe&) = delete;
  HostProbe& operator=(const HostProbe&) = delete;

  /// Asks what is not answered yet.
  void Ask();
  /// Answers and takes answers for so long.
  void Receive(std::chrono::milliseconds timeout);
  /// By host.
  const std::map<std::string, PeerReport>& peers() const { return peers_; }

 private:
  enum class Kind { kWhole, kInPieces, kMulticast };

  void Ask(const std::string& host, Kind kind, std::size_t size);
  bool Send(const std::string& text, std::size_t size, Kind kind, const sockaddr_in& to);
  void Take(const std::string& text, const std::string& host, const sockaddr_in& from);
  void TakeErrors();

  HostFacts own_;
  int port_;
  int socket_ = -1;
  std::map<std::string, sockaddr_in> addresses_;  // by host
  std::map<std::string, PeerReport> peers_;
};

}  // namespace conav::launcher
