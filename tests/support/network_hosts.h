#pragma once

#include <sys/types.h>

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace conav::test {

/// What the packets between hosts meet, in each direction.
struct LinkFaults {
  double loss = 0.0;  // share of the IP packets; a fragment is one
  std::chrono::microseconds delay{0};
  std::chrono::microseconds jitter{
      0};  // the delay is off by at most so much; packets keep their order
};

/// Hosts on this machine: network namespaces which see their network as interface "cn0" and reach
/// each other only through a hub, which is a thread of this process and can lose, delay and count
/// packets. The machine's own network is left alone. Needs root (NET_ADMIN and SYS_ADMIN) and
/// iproute2. The namespaces are gone with this object.
class NetworkHosts {
 public:
  enum class Multicast { kOff, kOn };
  /// Called by the hub for each Ethernet frame that arrives at a host.
  using Observer = std::function<void(int from, int to, std::span<const std::uint8_t> frame)>;

  /// At most 9.
  NetworkHosts(int count, Multicast multicast, Observer observer = nullptr);
  ~NetworkHosts();
  NetworkHosts(const NetworkHosts&) = delete;
  NetworkHosts& operator=(const NetworkHosts&) = delete;

  /// Why there are no hosts; empty when there are.
  const std::string& problem() const { return problem_; }
  /// The words that run a command on a host.
  std::string RunOn(int host) const { return "ip netns exec " + NameOf(host); }
  /// The same under the name that `hostname` prints on that host; for one command of the shell.
  std::string RunAs(int host, const std::string& name) const {
    return RunOn(host) + " unshare --uts sh -c 'hostname " + name + " && exec \"$0\" \"$@\"'";
  }
  /// Moves the calling thread, and those that it starts, to a host for good. Throws std::runtime_error.
  void Enter(int host) const;
  static std::string Address(int host) { return "10.77.0." + std::to_string(host + 1); }

  /// Of all packets that the hub receives from now on.
  void SetFaults(const LinkFaults& faults);
  /// Loses packets from and to that host of more than so many bytes, as a narrow way that says nothing.
  void SetLongest(int host, std::size_t bytes);
  /// Loses all packets from and to that host, or no longer.
  void Cut(int host, bool cut);

 private:
  class Hub;

  static std::string NameOf(int host);
  void AddNamespace(int host);
  void Run(const std::string& command);

  std::vector<int> namespaces_;
  std::string problem_;
  std::unique_ptr<Hub> hub_;
};

}  // namespace conav::test
