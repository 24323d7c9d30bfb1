#include "common/bus/network.h"

#include <algorithm>
#include <catch2/catch.hpp>

#include "common/bus/cyclone/backend.h"
#include "common/runtime/result.h"

namespace conav::bus {
namespace {

auto CountOf(const Network& network, const std::string& address) {
  return std::ranges::count(network.own_ports, address, &Peer::address) +
         std::ranges::count(network.remote_relays, address, &Peer::address);
}

TEST_CASE("the loopback interface means unicast to this machine", "[network]") {
  ParticipantOptions options;
  options.interface = GENERATE("lo", "127.0.0.1");
  const Network network = ResolveNetwork(options);
  CHECK(network.loopback);
  CHECK_FALSE(network.multicast);
  CHECK(network.interface_address == "127.0.0.1");
  REQUIRE(network.own_ports.size() == kHighestParticipantIndex + 1);
  CHECK(network.own_ports[0] == Peer{"127.0.0.1", 7410});
  CHECK(network.remote_relays.empty());
}

TEST_CASE("without interface and peers the vendor chooses, with multicast, peers switch it off",
          "[network]") {
  const Network open = ResolveNetwork({});
  CHECK(open.multicast);
  CHECK(open.interface_name.empty());
  CHECK(open.own_ports.empty());
  ParticipantOptions options;
  options.peers = {"10.1.2.3", "localhost", "10.1.2.3"};
  const Network network = ResolveNetwork(options);
  CHECK_FALSE(network.multicast);
  CHECK(CountOf(network, "127.0.0.1") == kHighestParticipantIndex + 1);
  CHECK(CountOf(network, "10.1.2.3") == 1);
}

TEST_CASE("announcements go to the ports of RTPS", "[network]") {
  ParticipantOptions options;
  options.domain_id = 3;
  options.peers = {"10.1.2.3"};
  const Network network = ResolveNetwork(options);
  CHECK(network.own_ports[0].port == 7400 + 3 * 250 + 10);
  REQUIRE(network.remote_relays.size() == 1);
  CHECK(network.remote_relays[0] == Peer{"10.1.2.3", 7400 + 3 * 250 + 10 + 2 * 61});
}

TEST_CASE("announcements are sparser over links than on loopback", "[network]") {
  ParticipantOptions options;
  options.peers = {"10.1.2.3"};
  const auto interval = [&] { return CycloneConfiguration(ResolveNetwork(options), 10.0); };
  CHECK_THAT(interval(), Catch::Contains("<SPDPInterval>1500 ms</SPDPInterval>"));
  options.interface = "lo";
  CHECK_THAT(interval(), Catch::Contains("<SPDPInterval>1000 ms</SPDPInterval>"));
}

TEST_CASE("user data is a list of keys and values, as in ROS 2", "[network]") {
  const std::string sparse = EndpointUserData("lab", {.demand = Demand::kSparse}, true);
  CHECK(ValueOf(kSystemKey, sparse) == "lab");
  CHECK_FALSE(ValueOf(kSparseKey, sparse).empty());
  CHECK(ValueOf(kSparseKey, EndpointUserData("lab", {}, false)).empty());
  constexpr Qos kOverLinks{.demand = Demand::kSparseOverLinks};
  CHECK(ValueOf(kSparseKey, EndpointUserData("lab", kOverLinks, true)).empty());
  CHECK_FALSE(ValueOf(kSparseKey, EndpointUserData("lab", kOverLinks, false)).empty());
  CHECK(ValueOf("enclave", ParticipantUserData("/conav/h1/sim")) == "/conav/h1/sim");
  for (const char* without :
       {"", ";;", "typehash=RIHS01_df668c74;", "conav_system", "conav_system;", "conav_system=;",
        "x_conav_system=lab;", "conav_systems=lab;"}) {
    CAPTURE(without);
    CHECK(ValueOf(kSystemKey, without).empty());
  }
  CHECK(ValueOf(kSystemKey, "typehash=x;conav_system=lab") == "lab");
}

TEST_CASE("an unknown interface and a peer without address are refused by name", "[network]") {
  ParticipantOptions options;
  options.interface = "eth_none";
  CHECK_THROWS_WITH(ResolveNetwork(options), Catch::Contains("eth_none") && Catch::Contains("lo"));
  options.interface = "lo";
  options.peers = {"no such host"};
  CHECK_THROWS_WITH(ResolveNetwork(options), Catch::Contains("no such host"));
}

}  // namespace
}  // namespace conav::bus
