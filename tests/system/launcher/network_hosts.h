#pragma once

#include <string>
#include <vector>

namespace conav::testing {

enum class Multicast { kOff, kOn };

/// Hosts on this machine: network namespaces that are joined by a bridge, with or without
/// multicast, and without loopback between each other. Removed at the end. Each sees its network as
/// interface "cn0".
class NetworkHosts {
 public:
  NetworkHosts(int count, Multicast multicast);
  ~NetworkHosts();
  NetworkHosts(const NetworkHosts&) = delete;
  NetworkHosts& operator=(const NetworkHosts&) = delete;

  /// Why there are no hosts; empty when there are.
  const std::string& problem() const { return problem_; }
  /// The words that run a command on a host.
  std::vector<std::string> RunOn(int host) const;
  std::string Address(int host) const;

 private:
  bool Run(const std::string& command);
  std::string Name(int host) const;
  void AddHost(int host, Multicast multicast);

  std::vector<std::string> namespaces_;
  std::string problem_;
};

}  // namespace conav::testing
