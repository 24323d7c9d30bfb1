#include <catch2/catch.hpp>
#include <iostream>

#include "system/launcher/demo_run.h"
#include "system/launcher/network_hosts.h"

using conav::testing::DemoRun;
using conav::testing::Multicast;
using conav::testing::NetworkHosts;

namespace {

std::string OnHost(const NetworkHosts& hosts, const std::string& service, int host) {
  std::string text = service + "=";
  for (const std::string& word : hosts.RunOn(host)) text += word + " ";
  return text;
}

// sim on the first host, planner and nhpm on the second, the operator's side on the third.
void RunsOnThreeHosts(const std::string& dds, Multicast multicast) {
  const NetworkHosts hosts(3, multicast);
  if (!hosts.problem().empty()) {
    std::cout << "skipped: no network namespaces here: " << hosts.problem() << '\n';
    return;
  }
  std::vector<std::string> arguments = {"--headless",
                                        "--seed",
                                        "10",
                                        "--dds",
                                        dds,
                                        "--interface",
                                        "cn0",
                                        "--run-with",
                                        OnHost(hosts, "sim", 0),
                                        "--run-with",
                                        OnHost(hosts, "planner", 1),
                                        "--run-with",
                                        OnHost(hosts, "nhpm", 1)};
  if (multicast == Multicast::kOff) {
    arguments.push_back("--peers");
    arguments.push_back(hosts.Address(0) + "," + hosts.Address(1) + "," + hosts.Address(2));
  }
  DemoRun demo(arguments, hosts.RunOn(2));
  const int code = demo.Wait();
  INFO(demo.Story());
  CHECK(code == 0);
  CHECK(demo.Json()["all_goals_reached"] == true);
}

}  // namespace

TEST_CASE("a demo runs on three hosts on Cyclone DDS", "[launcher][system]") {
  RunsOnThreeHosts("cyclonedds", Multicast::kOff);
}

TEST_CASE("a demo runs on three hosts on Fast DDS", "[launcher][system]") {
  RunsOnThreeHosts("fastdds", Multicast::kOff);
}

TEST_CASE("a demo runs on three hosts with both vendors", "[launcher][system]") {
  RunsOnThreeHosts("mixed", Multicast::kOff);
}

TEST_CASE("hosts with multicast find each other without being told of", "[launcher][system]") {
  RunsOnThreeHosts("mixed", Multicast::kOn);
}
