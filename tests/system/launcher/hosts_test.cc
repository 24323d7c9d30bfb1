#include <catch2/catch.hpp>
#include <iostream>

#include "support/network_hosts.h"
#include "system/launcher/demo_run.h"

namespace conav::testing {
namespace {

using test::NetworkHosts;

// sim on the first host, planner and nhpm on the second, the operator's side on the third.
void RunsOnThreeHosts(const std::string& dds, NetworkHosts::Multicast multicast) {
  const NetworkHosts hosts(3, multicast);
  if (!hosts.problem().empty()) {
    std::cout << "skipped: no network namespaces here: " << hosts.problem() << '\n';
    return;
  }
  std::string arguments = fmt::format(
      "--headless --seed 10 --dds {} --interface cn0 --run-with 'sim={}' --run-with 'planner={}' "
      "--run-with 'nhpm={}'",
      dds, hosts.RunOn(0), hosts.RunOn(1), hosts.RunOn(1));
  if (multicast == NetworkHosts::Multicast::kOff) {
    const auto address = [](int host) { return NetworkHosts::Address(host); };
    arguments += fmt::format(" --peers {},{},{}", address(0), address(1), address(2));
  }
  DemoRun(arguments, hosts.RunOn(2)).ReachesAllGoals();
}

}  // namespace

TEST_CASE("a demo runs on three hosts", "[demo]") {
  RunsOnThreeHosts(GENERATE("cyclonedds", "fastdds", "mixed"), NetworkHosts::Multicast::kOff);
}

TEST_CASE("hosts with multicast find each other without peers", "[demo]") {
  RunsOnThreeHosts("mixed", NetworkHosts::Multicast::kOn);
}

}  // namespace conav::testing
