#include <catch2/catch.hpp>
#include <iostream>

#include "system/launcher/demo_run.h"
#include "system/launcher/network_hosts.h"

using conav::testing::DemoRun;
using conav::testing::NetworkHosts;

namespace {

std::string OnHost(const NetworkHosts& hosts, const std::string& service, int host) {
  std::string text = service + "=";
  for (const std::string& word : hosts.RunOn(host)) text += word + " ";
  return text;
}

// sim on the first host, planner and nhpm on the second, the operator's side on the third.
void RunsOnThreeHosts(const std::string& dds) {
  const NetworkHosts hosts(3);
  if (!hosts.problem().empty()) {
    std::cout << "skipped: no network namespaces here: " << hosts.problem() << '\n';
    return;
  }
  const std::string peers = hosts.Address(0) + "," + hosts.Address(1) + "," + hosts.Address(2);
  DemoRun demo({"--headless", "--seed", "10", "--dds", dds, "--interface", "cn0", "--peers", peers,
                "--run-with", OnHost(hosts, "sim", 0), "--run-with", OnHost(hosts, "planner", 1),
                "--run-with", OnHost(hosts, "nhpm", 1)},
               hosts.RunOn(2));
  const int code = demo.Wait();
  INFO(demo.Story());
  CHECK(code == 0);
  CHECK(demo.Json()["all_goals_reached"] == true);
}

}  // namespace

TEST_CASE("a demo runs on three hosts on Cyclone DDS", "[launcher][system]") {
  RunsOnThreeHosts("cyclonedds");
}

TEST_CASE("a demo runs on three hosts on Fast DDS", "[launcher][system]") {
  RunsOnThreeHosts("fastdds");
}

TEST_CASE("a demo runs on three hosts with both vendors", "[launcher][system]") {
  RunsOnThreeHosts("mixed");
}
