// Hosts on this machine: network namespaces that a bridge joins.
#include <unistd.h>

#include <catch2/catch.hpp>
#include <cstdlib>
#include <iostream>

#include "system/launcher/demo_run.h"

namespace conav::testing {
namespace {

enum class Multicast { kOff, kOn };

/// Three hosts without loopback between each other; each sees its network as interface "cn0". They
/// are gone with this object.
class NetworkHosts {
 public:
  explicit NetworkHosts(Multicast multicast) {
    // The bridge lives in a namespace of its own, so that this machine's network is left alone.
    const std::string bridge = AddNamespace("bridge");
    Run(
        fmt::format("ip -n {0} link add br0 type bridge mcast_snooping 0 && "
                    "ip -n {0} link set br0 up",
                    bridge));
    for (int host = 0; host < 3 && problem_.empty(); ++host) {
      const std::string name = AddNamespace(std::to_string(host));
      Run(fmt::format(
          "ip -n {0} link add cn0 type veth peer name port{2} netns {1} && "
          "ip -n {1} link set port{2} master br0 up && "
          "ip -n {0} addr add {3}/24 dev cn0 && "
          "ip -n {0} link set cn0 multicast {4} up && ip -n {0} link set lo up",
          name, bridge, host, Address(host), multicast == Multicast::kOn ? "on" : "off"));
    }
  }
  ~NetworkHosts() {
    for (const std::string& name : namespaces_) Run("ip netns del " + name);
  }
  NetworkHosts(const NetworkHosts&) = delete;
  NetworkHosts& operator=(const NetworkHosts&) = delete;

  /// Why there are no hosts; empty when there are.
  const std::string& problem() const { return problem_; }
  /// The words that run a command on a host.
  std::string RunOn(std::size_t host) const { return "ip netns exec " + namespaces_.at(host + 1); }
  static std::string Address(int host) { return fmt::format("10.77.0.{}", host + 1); }

 private:
  std::string AddNamespace(const std::string& kind) {
    const std::string name = fmt::format("conav-{}-{}", getpid(), kind);
    if (Run("ip netns add " + name)) namespaces_.push_back(name);
    return name;
  }
  bool Run(const std::string& command) {
    const bool good = std::system(("(" + command + ") 2>/dev/null").c_str()) == 0;
    if (!good && problem_.empty()) problem_ = "'" + command + "' failed";
    return good;
  }

  std::vector<std::string> namespaces_;  // the bridge's first
  std::string problem_;
};

// sim on the first host, planner and nhpm on the second, the operator's side on the third.
void RunsOnThreeHosts(const std::string& dds, Multicast multicast) {
  const NetworkHosts hosts(multicast);
  if (!hosts.problem().empty()) {
    std::cout << "skipped: no network namespaces here: " << hosts.problem() << '\n';
    return;
  }
  std::string arguments = fmt::format(
      "--headless --seed 10 --dds {} --interface cn0 --run-with 'sim={}' --run-with 'planner={}' "
      "--run-with 'nhpm={}'",
      dds, hosts.RunOn(0), hosts.RunOn(1), hosts.RunOn(1));
  if (multicast == Multicast::kOff) {
    const auto address = [](int host) { return NetworkHosts::Address(host); };
    arguments += fmt::format(" --peers {},{},{}", address(0), address(1), address(2));
  }
  DemoRun(arguments, hosts.RunOn(2)).ReachesAllGoals();
}

}  // namespace

TEST_CASE("a demo runs on three hosts", "[demo]") {
  RunsOnThreeHosts(GENERATE("cyclonedds", "fastdds", "mixed"), Multicast::kOff);
}

TEST_CASE("hosts with multicast find each other without peers", "[demo]") {
  RunsOnThreeHosts("mixed", Multicast::kOn);
}

}  // namespace conav::testing
