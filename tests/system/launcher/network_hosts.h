#pragma once

#include <string>
#include <vector>

namespace conav::testing {

/// Hosts on this machine: network namespaces that are joined by a bridge, without multicast and
/// without loopback between each other. Removed at the end. Each sees its network as interface
/// "cn0".
class NetworkHosts {
 public:
  explicit NetworkHosts(int count);
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
  void AddHost(int host);

  std::vector<std::string> namespaces_;
  std::string problem_;
};

}  // namespace conav::testing
