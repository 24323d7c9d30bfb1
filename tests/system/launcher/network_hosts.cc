#include "system/launcher/network_hosts.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cstdlib>

namespace conav::testing {

NetworkHosts::NetworkHosts(int count, Multicast multicast) {
  // The bridge lives in a namespace of its own, so that this machine's network is left alone.
  const std::string bridge = Name(-1);
  if (!Run("ip netns add " + bridge)) return;
  namespaces_.push_back(bridge);
  Run(fmt::format("ip -n {} link add br0 type bridge mcast_snooping 0 && ip -n {} link set br0 up",
                  bridge, bridge));
  for (int host = 0; host < count && problem_.empty(); ++host) AddHost(host, multicast);
}

NetworkHosts::~NetworkHosts() {
  for (const std::string& name : namespaces_) Run("ip netns del " + name);
}

std::vector<std::string> NetworkHosts::RunOn(int host) const {
  return {"ip", "netns", "exec", Name(host)};
}

std::string NetworkHosts::Address(int host) const { return fmt::format("10.77.0.{}", host + 1); }

std::string NetworkHosts::Name(int host) const {
  return fmt::format("conav-{}-{}", getpid(), host < 0 ? "bridge" : std::to_string(host));
}

void NetworkHosts::AddHost(int host, Multicast multicast) {
  const std::string name = Name(host);
  const std::string bridge = namespaces_.front();
  if (!Run("ip netns add " + name)) return;
  namespaces_.push_back(name);
  Run(fmt::format("ip -n {0} link add cn0 type veth peer name port{2} netns {1}", name, bridge,
                  host));
  Run(fmt::format("ip -n {} link set port{} master br0 up", bridge, host));
  Run(fmt::format("ip -n {} addr add {}/24 dev cn0", name, Address(host)));
  Run(fmt::format("ip -n {} link set cn0 multicast {} up", name,
                  multicast == Multicast::kOn ? "on" : "off"));
  Run(fmt::format("ip -n {} link set lo up", name));
}

bool NetworkHosts::Run(const std::string& command) {
  const bool good = std::system((command + " 2>/dev/null").c_str()) == 0;
  if (!good && problem_.empty()) problem_ = "'" + command + "' failed";
  return good;
}

}  // namespace conav::testing
