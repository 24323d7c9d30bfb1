#include "launcher/hosts.h"

#include <catch2/catch.hpp>
#include <functional>

#include "common/runtime/file.h"
#include "common/service/service_main.h"
#include "keystore/keystore.h"
#include "nhpm/config.h"
#include "operator/config.h"
#include "operator/recording/config.h"
#include "planner/config.h"
#include "robot/driver/config.h"
#include "sim/config.h"
#include "support/temporary_folder.h"

namespace conav::launcher {
namespace {

namespace fs = std::filesystem;

const char* const kThree = R"(bus: {domain_id: 7, system: lab}
hosts:
  robot1: {address: 10.0.0.1, interface: wlan0, services: {sim: {robots: [r1]}}}
  base:
    address: 10.0.0.2
    vendor: fastdds
    services: {planner: {seed: 9}, nhpm: {}}
  desk: {address: 10.0.0.3, services: [operator]}
)";

/// What a StartupError says.
std::string Refusal(const std::function<void()>& act) {
  try {
    act();
  } catch (const StartupError& error) {
    return error.what();
  }
  return "";
}

struct Bench : test::TemporaryFolder {
  HostsPlan Load(const std::string& text) const {
    REQUIRE(WriteFile(path() / "hosts.yaml", text));
    return LoadHosts(path() / "hosts.yaml");
  }
  template <class Config>
  Config Written(const std::string& host, const std::string& service) const {
    return LoadConfig<Config>((out / host / (service + ".yaml")).string(), service);
  }
  std::string Text(const fs::path& file) const {
    const auto text = ReadFile(file);
    REQUIRE(text);
    return *text;
  }
  fs::path out = path() / "out";
};

TEST_CASE("each service loads what is written for it, on the bus of its host", "[hosts]") {
  const Bench bench;
  WriteHosts(bench.Load(kThree), bench.out);
  const auto sim = bench.Written<sim::SimConfig>("robot1", "sim");
  CHECK(sim.bus.domain_id == 7);
  CHECK(sim.bus.system == "lab");
  CHECK(sim.bus.interface == "wlan0");
  CHECK(sim.bus.peers == std::vector<std::string>{"10.0.0.1", "10.0.0.2", "10.0.0.3"});
  CHECK(sim.bus.keystore.empty());
  const auto planner = bench.Written<planner::PlannerConfig>("base", "planner");
  CHECK(planner.seed == 9);
  CHECK(planner.bus.vendor == bus::Vendor::kFastDds);
  bench.Written<nhpm::NhpmConfig>("base", "nhpm");
  bench.Written<operators::OperatorConfig>("desk", "operator");
}

TEST_CASE("the example's hosts get files that their services load", "[hosts]") {
  const Bench bench;
  const HostsPlan plan = LoadHosts(CONAV_SOURCE_DIR "/deploy/config/hosts.yaml");
  WriteHosts(plan, bench.out);
  CHECK(bench.Written<robot::DriverConfig>("robot1", "driver").robot_namespace == "/tb3");
  bench.Written<planner::PlannerConfig>("base", "planner");
  bench.Written<nhpm::NhpmConfig>("base", "nhpm");
  bench.Written<recorder::RecorderConfig>("base", "recorder");
  bench.Written<operators::OperatorConfig>("desk", "operator");
  CHECK_THAT(NextSteps(plan, bench.out),
             Catch::Contains("enable --now conav@planner conav@nhpm conav@recorder"));
}

TEST_CASE("a host's outline describes the same system, without the settings of services",
          "[hosts]") {
  const Bench bench;
  std::string text = kThree;
  text.replace(text.find("[operator]"), 10, "{operator: {database: sesame.db}}");
  const HostsPlan plan = bench.Load(text);
  WriteHosts(plan, bench.out);
  const fs::path outline = bench.out / "robot1" / "hosts.yaml";
  CHECK(LoadHosts(outline).checksum() == plan.checksum());
  CHECK(bench.Text(outline).find("sesame") == std::string::npos);
  CHECK(bench.Text(bench.out / "desk" / "operator.yaml").find("sesame") != std::string::npos);
  CHECK(bench.Load(std::string(kThree) + "multicast: true\n").checksum() != plan.checksum());
}

TEST_CASE("with a keystore each host has the keys of its services, until it has others",
          "[hosts]") {
  const Bench bench;
  const std::string text = std::string(kThree).replace(5, 1, "{keystore: keys, ");
  WriteHosts(bench.Load(text), bench.out);
  const auto sim = bench.Written<sim::SimConfig>("robot1", "sim");
  CHECK(sim.bus.keystore == "keystore");
  CHECK(sim.bus.enclave == "/conav/robot1/sim/cyclonedds");
  CHECK(bench.Written<planner::PlannerConfig>("base", "planner").bus.enclave ==
        "/conav/base/planner/fastdds");
  const auto key = [&](const std::string& host, const std::string& role) {
    return bench.out / host / "keystore" / "enclaves" / "conav" / host / role / "fastdds" /
           "key.pem";
  };
  CHECK_FALSE(fs::exists(bench.out / "robot1" / "keystore" / "enclaves" / "conav" / "base"));
  CHECK_FALSE(fs::exists(bench.out / "robot1" / "keystore" / "private"));
  const auto hosts = keystore::Hosts(bench.path() / "keys");
  REQUIRE(hosts.size() == 3);
  CHECK(hosts[2].grant.robots == std::vector<std::string>{"r1"});
  CHECK(hosts[0].grant.robots.empty());
  const std::string before = bench.Text(key("base", "nhpm"));
  WriteHosts(bench.Load(text), bench.out);
  CHECK(bench.Text(key("base", "nhpm")) == before);
  std::string other = text;
  WriteHosts(bench.Load(other.replace(other.find(", nhpm: {}"), 10, "")), bench.out);
  CHECK_FALSE(fs::exists(key("base", "nhpm")));
}

TEST_CASE("a wrong file is refused by key and line", "[hosts]") {
  const Bench bench;
  struct Row {
    std::string from;
    std::string to;
    std::vector<std::string> said;
  };
  const std::vector<Row> rows{
      {"hosts:", "host:", {"host"}},
      {"domain_id: 7", "domain_id: 700", {"domain_id = 700", "line 1"}},
      {"{domain_id: 7", "{interface: lo", {"interface", "line 1"}},
      {"address: 10.0.0.2", "adress: 10.0.0.2", {"base", "adress", "line 5"}},
      {"address: 10.0.0.2", "address: 10.0.0.1", {"base", "robot1", "10.0.0.1", "line 5"}},
      {"fastdds", "rti", {"base.vendor", "line 6"}},
      {"seed: 9", "sead: 9", {"base.services.planner", "sead", "line 7"}},
      {"seed: 9", "bus: {}", {"planner", "bus", "line 7"}},
      {"nhpm: {}", "nhpn: {}", {"nhpn", "line 7"}},
      {"nhpm: {}", "planner: {}", {"planner twice", "line 7"}},
      {"[operator]", "[planner]", {"desk", "the name planner", "line 8"}},
      {"[operator]", "{sim: {robots: [r1]}}", {"desk", "robot r1", "line 8"}},
      {"desk:", "base:", {"base twice", "line 8"}},
      {"desk:", "\"../desk\":", {"../desk", "line 8"}},
      {"[operator]", "{operator: nowhere.yaml}", {"nowhere.yaml"}},
      {"[operator]", "[operator, recorder, simulated-operator, {sim: {}}]", {"desk", "line 8"}}};
  for (const Row& row : rows) {
    std::string text = kThree;
    text.replace(text.find(row.from), row.from.size(), row.to);
    CAPTURE(row.to);
    const std::string said = Refusal([&] { bench.Load(text); });
    for (const std::string& part : row.said) CHECK_THAT(said, Catch::Contains(part));
  }
}

}  // namespace
}  // namespace conav::launcher
