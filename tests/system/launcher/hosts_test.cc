#include "launcher/hosts.h"

#include <catch2/catch.hpp>
#include <csignal>
#include <iostream>
#include <list>
#include <thread>

#include "common/service/robot_state_topics.h"
#include "keystore/keystore.h"
#include "launcher/host_probe.h"
#include "support/network_hosts.h"
#include "system/console_page.h"
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

namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr std::array kNames{"robot1", "base", "desk"};

/// A time of day that is wrong, for a program that has words() before its own.
class WrongClock : test::TemporaryFolder {
 public:
  /// By this many seconds from now on.
  void Set(const std::string& offset_s) { REQUIRE(WriteFile(*this / "offset", offset_s + "\n")); }
  /// Empty, and a line that says so, where there is no libfaketime.
  std::string words() const {
    const std::string library = "/usr/lib/x86_64-linux-gnu/faketime/libfaketimeMT.so.1";
    if (!fs::exists(library)) {
      std::cout << "skipped: no libfaketime\n";
      return "";
    }
    return fmt::format(
        "env LD_PRELOAD={} FAKETIME_TIMESTAMP_FILE={} FAKETIME_NO_CACHE=1 "
        "FAKETIME_DONT_FAKE_MONOTONIC=1",
        library, (*this / "offset").string());
  }
};

/// Three hosts with what `conav hosts` wrote for them.
struct WrittenHosts : test::TemporaryFolder {
  /// `bus`: more of that section, "keystore: keys, ". `desk`: more of the third host.
  explicit WrittenHosts(const std::string& bus = "", const std::string& desk = "") {
    if (!hosts.problem().empty()) {
      std::cout << "skipped: no network namespaces here: " << hosts.problem() << '\n';
      return;
    }
    Rewrite(file, bus, desk);
    test::RunningProgram writes("conav-hosts",
                                fmt::format("hosts {} --out {}", file.string(), path().string()),
                                path() / "hosts.txt");
    INFO(writes.Output());
    REQUIRE(writes.Wait().exit_code == 0);
  }
  void Rewrite(const fs::path& to, const std::string& bus, const std::string& desk) const {
    const auto written =
        WriteFile(to, fmt::format(R"(
bus: {{{0}domain_id: {1}, system: lab}}
hosts:
  robot1:
    address: {2}
    interface: cn0
    services:
      sim: {{robots: [r1], seed: 10, speed: 0.0, camera: {{mode: none}}}}
  base:
    address: {3}
    interface: cn0
    vendor: fastdds
    services: {{planner: {{}}, nhpm: {{}}}}
  desk:
    address: {4}
    interface: cn0
    {5}
    services: {{operator: {{console: {{port: -1}}}}, simulated-operator: {{}}}}
)",
                                  bus, TestDomain(), NetworkHosts::Address(0),
                                  NetworkHosts::Address(1), NetworkHosts::Address(2), desk));
    REQUIRE(written);
  }
  /// As a unit does: in its host's folder.
  void Start(int host, const std::string& service) {
    const std::string name = kNames[static_cast<std::size_t>(host)];
    services.emplace_back(
        "conav-" + service, "--config " + service + ".yaml", path() / (service + ".log"),
        fmt::format("env -C {} {}", (path() / name).string(), hosts.RunAs(host, name)));
  }
  void StartAll() {
    Start(0, "sim");
    Start(1, "planner");
    Start(1, "nhpm");
    Start(2, "operator");
    Start(2, "simulated-operator");
  }
  /// What the doctor on `host` says; `answering`: the hosts whose doctors answer meanwhile, after these `words`.
  json Examine(int host, const std::vector<int>& answering, int exit_code,
               const std::string& words = "") {
    std::list<test::RunningProgram> others;
    for (const int other : answering) {
      const std::string name = kNames[static_cast<std::size_t>(other)];
      others.emplace_back(
          "conav-hosts",
          fmt::format("doctor hosts {}/{}/hosts.yaml --answer", path().string(), name),
          path() / (name + ".txt"), fmt::format("{} {}", hosts.RunAs(other, name), words));
      REQUIRE(others.back().Prints("answers"));
    }
    const std::string name = kNames[static_cast<std::size_t>(host)];
    const fs::path report = path() / "report.json";
    test::RunningProgram doctor("conav-hosts",
                                fmt::format("doctor hosts {}/{}/hosts.yaml --wait 20 --json {}",
                                            path().string(), name, report.string()),
                                path() / "doctor.txt", hosts.RunAs(host, name));
    const int code = doctor.Wait().exit_code;
    INFO(doctor.Output());
    CHECK(code == exit_code);
    const auto text = ReadFile(report);
    REQUIRE(text);
    return json::parse(*text)["checks"];
  }

  NetworkHosts hosts{3, NetworkHosts::Multicast::kOff};
  fs::path file = path() / "hosts.yaml";
  std::list<test::RunningProgram> services;
};

/// "OK", or the empty text without such a row.
std::string LevelOf(const json& checks, const std::string& host, const std::string& check) {
  for (const json& row : checks) {
    if (row["host"] == host && row["check"] == check) return row["level"];
  }
  return "";
}

/// Whether r1 has no goal left, as a program on that host sees it.
bool ReachesGoals(const NetworkHosts& hosts, int host) {
  bool reached = false;
  std::jthread([&] {
    hosts.Enter(host);
    bus::ParticipantOptions options;
    options.domain_id = TestDomain();
    options.interface = "cn0";
    options.system = "lab";
    for (int peer = 0; peer < 3; ++peer) options.peers.push_back(NetworkHosts::Address(peer));
    bus::Participant participant("watcher", options);
    RobotStateTopics robot(participant, "r1");
    reached = WaitUntil(
        [&] {
          const auto states = robot.TakeStamped();
          return std::ranges::any_of(states, [](const auto& state) {
            return state.value.goals_total > 0 && state.value.goals_left.empty();
          });
        },
        std::chrono::minutes(3));
  }).join();
  return reached;
}

}  // namespace

TEST_CASE("three hosts run from one hosts.yaml", "[hosts]") {
  WrittenHosts system;
  if (!system.hosts.problem().empty()) return;
  system.StartAll();
  CHECK(ReachesGoals(system.hosts, 2));
  const json checks = system.Examine(2, {0}, 0);
  for (const json& row : checks) {
    CAPTURE(row.dump());
    CHECK(row["level"] == "OK");
  }
  for (const char* check :
       {"reach", "mtu", "multicast", "clock", "version", "hosts.yaml", "services"}) {
    CHECK(LevelOf(checks, "robot1", check) == "OK");
  }
  CHECK(LevelOf(checks, "base", "reach") == "OK");  // on the bus
  CHECK(LevelOf(checks, "base", "clock") == "OK");
}

TEST_CASE("three hosts run from one hosts.yaml with keys", "[hosts][security]") {
  WrittenHosts system("keystore: keys, ", "tools: true");
  if (!system.hosts.problem().empty()) return;
  system.StartAll();
  const auto answer = [&] {
    const json checks = system.Examine(2, {0}, 0);
    return LevelOf(checks, "robot1", "services") == "OK" &&
           LevelOf(checks, "base", "services") == "OK" && LevelOf(checks, "desk", "keys") == "OK" &&
           LevelOf(checks, "robot1", "authority") == "OK";
  };
  CHECK(WaitUntil(answer, std::chrono::minutes(1)));
}

TEST_CASE("the doctor of hosts names what is wrong", "[hosts]") {
  WrittenHosts system("keystore: keys, ", "tools: true");
  if (!system.hosts.problem().empty()) return;
  SECTION("a host that cannot be reached, one without a doctor, other keys, versions of the file") {
    system.hosts.Cut(0, true);
    const json checks = system.Examine(2, {}, 1);
    CHECK(LevelOf(checks, "robot1", "reach") == "FAIL");
    CHECK(LevelOf(checks, "base", "reach") == "WARN");
    CHECK(LevelOf(checks, "base", "services") == "WARN");
  }
  SECTION("a small MTU on the way, a hosts.yaml of another time, keys of another authority") {
    system.hosts.SetLongest(0, 1300);
    system.Rewrite(system.path() / "robot1" / "hosts.yaml", "keystore: other, ", "tools: false");
    const json checks = system.Examine(2, {0, 1}, 1);
    CHECK(LevelOf(checks, "robot1", "reach") == "OK");
    CHECK(LevelOf(checks, "robot1", "mtu") == "FAIL");
    CHECK(LevelOf(checks, "base", "mtu") == "OK");
    CHECK(LevelOf(checks, "robot1", "hosts.yaml") == "FAIL");
    CHECK(LevelOf(checks, "robot1", "authority") == "FAIL");
  }
  SECTION("multicast that does not pass, a clock of another time, a doctor of another version") {
    WrongClock clock;
    if (clock.words().empty()) return;
    clock.Set("+2");
    const auto plan_of_desk = ReadFile(system.path() / "desk" / "hosts.yaml");
    REQUIRE(plan_of_desk);
    REQUIRE(WriteFile(system.path() / "desk" / "hosts.yaml", "multicast: true\n" + *plan_of_desk));
    const std::jthread older([&](const std::stop_token& stop) {
      system.hosts.Enter(1);
      const auto plan = launcher::LoadHosts(system.path() / "base" / "hosts.yaml");
      launcher::HostProbe probe(plan, {"base", "0.0.1", plan.checksum(), ""}, TestDomain());
      while (!stop.stop_requested()) probe.Receive(std::chrono::milliseconds(100));
    });
    const json checks = system.Examine(2, {0}, 1, clock.words());
    CHECK(LevelOf(checks, "robot1", "multicast") == "FAIL");
    CHECK(LevelOf(checks, "robot1", "clock") == "WARN");
    CHECK(LevelOf(checks, "robot1", "version") == "OK");
    CHECK(LevelOf(checks, "base", "clock") == "OK");
    CHECK(LevelOf(checks, "base", "version") == "FAIL");
  }
  SECTION("expired keys") {
    fs::remove_all(system.path() / "keys");
    keystore::Init(system.path() / "keys", 30);
    keystore::Add(system.path() / "keys", {"desk", {"operator", "simulated_operator", "tools"}, {}},
                  -1);
    fs::copy(system.path() / "keys" / "enclaves", system.path() / "desk" / "keystore" / "enclaves",
             fs::copy_options::recursive | fs::copy_options::overwrite_existing);
    CHECK(LevelOf(system.Examine(2, {}, 1), "desk", "keys") == "FAIL");
  }
}

TEST_CASE("the doctor of hosts meets another system in the domain", "[hosts]") {
  WrittenHosts system;
  if (!system.hosts.problem().empty()) return;
  system.Rewrite(system.path() / "desk" / "hosts.yaml", "lease_s: 5.0, ", "");
  const auto mine = ReadFile(system.path() / "desk" / "hosts.yaml");
  REQUIRE(mine);
  std::string other = *mine;
  other.replace(other.find("lab"), 3, "gym");
  REQUIRE(WriteFile(system.path() / "desk" / "hosts.yaml", other));
  system.Start(0, "sim");
  CHECK(WaitUntil([&] { return LevelOf(system.Examine(2, {}, 0), "desk", "domain") == "WARN"; },
                  std::chrono::minutes(1)));
}

namespace {

/// Reads on until three states in turn are as new as they are, by a service's clock that is `ahead_s`.
void ReadRightAges(operators::ConsolePage& page, double ahead_s) {
  double stamp = -1.0;
  // Robots wait for the operator and report once a second.
  int read = 0;
  for (int right = 0; right < 3;) {
    REQUIRE(++read < 60);
    page.ReadUntil([&] { return page.robot.stamp() > stamp; });
    stamp = page.robot.stamp();
    const double age_s = WallSeconds() + ahead_s - page.robot.received_at();
    right = age_s >= -0.001 && age_s < 0.4 ? right + 1 : 0;
  }
}

}  // namespace

// The faults report's (d), with real clocks: "sim 0.5 s behind shows age 0.66 s for good, 2 s behind 2.1 s =
// \"stale\" for good", "Operator stepped -2 s: all ages +2 s".
TEST_CASE("ages are right although a clock is wrong or set", "[clock]") {
  WrongClock clock;
  if (clock.words().empty()) return;
  const std::string service = GENERATE("sim", "operator");
  const std::string vendor = GENERATE("cyclonedds", "fastdds");
  CAPTURE(service, vendor);
  clock.Set("+0.5");
  DemoRun demo(fmt::format("--console 0 --camera none --dds {} --run-with '{}={}'", vendor, service,
                           clock.words()));
  REQUIRE(demo.Prints("http://127.0.0.1:"));
  const std::string output = demo.Output();
  operators::ConsolePage page(std::stoi(output.substr(output.find("127.0.0.1:") + 10)));
  ReadRightAges(page, service == "sim" ? 0.0 : 0.5);
  clock.Set("-2");
  ReadRightAges(page, service == "sim" ? 0.0 : -2.0);
  demo.Signal(SIGINT);
  demo.Wait();
}

TEST_CASE("no command expires early although a clock is wrong or set", "[clock]") {
  WrongClock clock;
  if (clock.words().empty()) return;
  const std::string service = GENERATE("sim", "planner");
  CAPTURE(service);
  clock.Set("+0.5");
  DemoRun demo(fmt::format("--headless --robots 2 --camera none --speed 4 --run-with '{}={}'",
                           service, clock.words()));
  demo.WaitForMoves("r1");
  clock.Set("-2");
  demo.ReachesAllGoals();
  const auto log = ReadFile(demo.RunFolder() / "logs" / "planner.log");
  REQUIRE(log);
  CHECK(log->find("command expired") == std::string::npos);
}

}  // namespace conav::testing
