// DDS security with the keystore's own files: both vendors, in clear nothing, and intruders.
#include <fmt/core.h>

#include <catch2/catch.hpp>
#include <csignal>
#include <filesystem>
#include <list>
#include <optional>

#include "common/bus/backend.h"
#include "common/bus/publisher.h"
#include "common/bus/subscriber.h"
#include "keystore/keystore.h"
#include "support/child_process.h"
#include "support/loopback.h"
#include "support/running_program.h"
#include "support/scoped_variable.h"
#include "support/temporary_folder.h"
#include "support/wait.h"
#include "system/security/sniffer.h"

namespace conav::test {
namespace {

namespace fs = std::filesystem;
using bus::Participant;
using bus::Publisher;
using bus::Subscriber;
using conav_msgs::msg::RobotCommand;
using conav_msgs::msg::RobotState;
using std::chrono::steady_clock;

/// A keystore with the host h1.
struct Keystore : TemporaryFolder {
  Keystore() {
    keystore::Init(path() / "keys", 30);
    AddHost({"sim", "planner", "nhpm", "recorder"}, {});
  }
  void AddHost(std::vector<std::string> roles, std::vector<std::string> topics) {
    keystore::Add(path() / "keys", {"h1", std::move(roles), {{}, std::move(topics)}}, 10);
  }
  fs::path EnclaveFolder(const std::string& role, const std::string& vendor) const {
    return path() / "keys" / "enclaves" / "conav" / "h1" / role / vendor;
  }
  bus::ParticipantOptions Options(const std::string& role, const std::string& vendor) const {
    bus::ParticipantOptions options = OnLoopback(vendor);
    options.keystore = path() / "keys";
    options.enclave = fmt::format("/conav/h1/{}/{}", role, vendor);
    return options;
  }
};

RobotCommand CommandOf(const std::string& sender, std::uint64_t sequence) {
  RobotCommand command;
  command.robot(sender);
  command.sequence_number(sequence);
  return command;
}

/// Texts that no other test puts on the loopback interface.
const std::string kGenuine = "genuine-9c1fd2b44a6d7e02";
const std::string kRobot = "r9c1fd2b4";

/// A simulator that reports a robot's state and a planner that commands it, as conav's services do.
struct Pair {
  Pair(const bus::ParticipantOptions& of_sim, const bus::ParticipantOptions& of_planner)
      : sim("sim", of_sim),
        planner("planner", of_planner),
        states(sim, bus::kRobotState, kRobot),
        seen_states(planner, bus::kRobotState, kRobot),
        commands(planner, bus::kRobotCommand, kRobot),
        seen_commands(sim, bus::kRobotCommand, kRobot) {}

  /// One message each way, within `limit`.
  bool Exchange(std::chrono::milliseconds limit = std::chrono::seconds(20)) {
    RobotState state;
    state.robot(kGenuine);
    state.moves(++number);
    bool state_came = false;
    bool command_came = false;
    REQUIRE(states.Publish(state));
    REQUIRE(commands.Publish(CommandOf(kGenuine, number)));
    return WaitUntil(
        [&] {
          for (const auto& one : seen_states.Take()) state_came |= one.moves() == number;
          for (const auto& one : seen_commands.Take()) {
            command_came |= one.robot() == kGenuine && one.sequence_number() == number;
            received.push_back(one);
          }
          return state_came && command_came;
        },
        limit);
  }

  Participant sim;
  Participant planner;
  Publisher<RobotState> states;
  Subscriber<RobotState> seen_states;
  Publisher<RobotCommand> commands;
  Subscriber<RobotCommand> seen_commands;
  std::uint32_t number = 0;
  std::vector<RobotCommand> received;  // by the simulator
};

/// security_peer, which reads and writes the commands to kRobot.
class Peer {
 public:
  Peer(std::string name, const std::string& vendor, const bus::ParticipantOptions& options)
      : name_(std::move(name)),
        process_(fmt::format("exec '{}/security_peer' '{}' {} {} {} {} {}", CONAV_BIN_DIR, name_,
                             vendor, options.domain_id,
                             options.keystore.empty() ? "-" : options.keystore,
                             options.enclave.empty() ? "/" : options.enclave, kRobot)) {
    REQUIRE(process_.ReadUntil("\n"));
    writes_ = process_.TakeText() == "ready\n";
  }

  void Write(int count) { process_.Send(fmt::format("write {}", count)); }
  /// How many genuine commands it has read.
  int Read() {
    process_.TakeText();
    process_.Send("read");
    REQUIRE(process_.ReadUntil("\n"));
    return std::stoi(process_.text().substr(5));
  }

  const std::string& name() const { return name_; }
  /// Its own vendor's library may refuse; that of an attacker who changed the library does not.
  bool writes() const { return writes_; }

 private:
  std::string name_;
  ChildProcess process_;
  bool writes_ = false;
};

/// Whether a command of `planner`, called kGenuine, reaches a simulator within `limit`.
bool Commands(Subscriber<RobotCommand>& simulator, Peer& planner, std::chrono::milliseconds limit) {
  return WaitUntil(
      [&] {
        planner.Write(1);
        const auto taken = simulator.Take();
        return !taken.empty() && taken.back().robot() == kGenuine;
      },
      limit);
}

TEST_CASE("programs of both vendors talk by their enclaves, and a sniffer reads nothing of it",
          "[system][security]") {
  const std::string of_sim = GENERATE("cyclonedds", "fastdds");
  const std::string of_planner = GENERATE("cyclonedds", "fastdds");
  CAPTURE(of_sim, of_planner);
  const Keystore keys;
  Sniffer sniffer;
  {
    Participant sim("sim", keys.Options("sim", of_sim));
    Subscriber<RobotCommand> commands(sim, bus::kRobotCommand, kRobot);
    Peer planner(kGenuine, of_planner, keys.Options("planner", of_planner));
    Peer recorder("recorder", of_sim, keys.Options("recorder", of_sim));
    CHECK(planner.writes());
    CHECK_FALSE(recorder.writes());
    CHECK(Commands(commands, planner, std::chrono::seconds(20)));
    CHECK(WaitUntil([&] {
      planner.Write(1);
      return recorder.Read() > 0;
    }));
  }
  if (!sniffer.allowed()) {
    WARN("not a superuser: nothing was sniffed");
    return;
  }
  CHECK(sniffer.Stop().size() > 50);
  CHECK(sniffer.CountWith(kGenuine) == 0);
  CHECK(sniffer.CountWith(kRobot) == 0);
}

/// Sends every captured datagram again, and `garbage` datagrams that begin as RTPS, to the same ports.
void Resend(const std::vector<Datagram>& datagrams, int garbage) {
  const int out = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  const auto send = [out](const sockaddr_in& to, const std::string& payload) {
    sendto(out, payload.data(), payload.size(), 0, reinterpret_cast<const sockaddr*>(&to),
           sizeof to);
  };
  for (const Datagram& datagram : datagrams) send(datagram.to, datagram.payload);
  for (int i = 0; i < garbage && !datagrams.empty(); ++i) {
    const Datagram& like = datagrams[static_cast<std::size_t>(i) % datagrams.size()];
    std::string payload = like.payload.substr(0, 20);
    for (int k = 0; k < 200; ++k) payload += static_cast<char>((i * 131 + k * 17) & 0xff);
    send(like.to, payload);
  }
  close(out);
}

/// A copy of an enclave with one file of another one: another's identity with one's own key, say.
std::string Forged(const Keystore& keys, const fs::path& enclave, const fs::path& file_from,
                   const std::string& file, const std::string& name) {
  const fs::path copy = keys.path() / "keys" / "enclaves" / name;
  fs::copy(enclave, copy);
  fs::copy_file(file_from / file, copy / file, fs::copy_options::overwrite_existing);
  return "/" + name;
}

/// All that read and write without the right papers.
std::list<Peer> Intrude(const Keystore& keys, const Keystore& foreign, const std::string& vendor) {
  const auto as = [](bus::ParticipantOptions options, const std::string& enclave) {
    options.enclave = enclave;
    return options;
  };
  const auto planner = keys.EnclaveFolder("planner", vendor);
  const auto stolen_certificate = Forged(keys, planner, foreign.EnclaveFolder("planner", vendor),
                                         "key.pem", "certificate_" + vendor);
  const auto stolen_permissions = Forged(keys, keys.EnclaveFolder("nhpm", vendor), planner,
                                         "permissions.p7s", "permissions_" + vendor);
  std::list<Peer> intruders;
  intruders.emplace_back(vendor + " without certificate", vendor, OnLoopback(vendor));
  intruders.emplace_back(vendor + " foreign authority", vendor, foreign.Options("planner", vendor));
  intruders.emplace_back(vendor + " foreign authority, certificate of a planner", vendor,
                         as(keys.Options("planner", vendor), stolen_certificate));
  intruders.emplace_back(vendor + " another service", vendor, keys.Options("nhpm", vendor));
  intruders.emplace_back(vendor + " another service, permissions of a planner", vendor,
                         as(keys.Options("nhpm", vendor), stolen_permissions));
  return intruders;
}

/// Twelve: without certificate, by another authority's and by that of a service of other topics each reads,
/// forges and impersonates a planner; the first two flood; packets are replayed.
TEST_CASE("twelve intrusions by programs of either vendor: none succeeds", "[system][security]") {
  const std::string of_sim = GENERATE("cyclonedds", "fastdds");
  CAPTURE(of_sim);
  const Keystore keys;
  Keystore foreign;
  foreign.AddHost({"planner"}, {"/" + kRobot + "/command"});
  Sniffer sniffer;
  Pair pair(keys.Options("sim", of_sim),
            keys.Options("planner", of_sim == "fastdds" ? "cyclonedds" : "fastdds"));
  for (int i = 0; i < 5; ++i) REQUIRE(pair.Exchange());
  const std::vector<Datagram> captured = sniffer.Stop();
  if (sniffer.allowed()) REQUIRE(captured.size() > 20);

  std::list<Peer> intruders;
  for (const std::string vendor : {"cyclonedds", "fastdds"}) {
    intruders.splice(intruders.end(), Intrude(keys, foreign, vendor));
  }
  // In clear they need well below a second: see the next test.
  const auto until = steady_clock::now() + std::chrono::seconds(3);
  while (steady_clock::now() < until) {
    for (Peer& intruder : intruders) intruder.Write(100);
    Resend(captured, 200);
    CHECK(pair.Exchange());
  }
  for (Peer& intruder : intruders) {
    CAPTURE(intruder.name());
    CHECK(intruder.Read() == 0);
    // The libraries of both vendors let these try.
    if (intruder.name().ends_with("without certificate")) CHECK(intruder.writes());
    if (intruder.name().ends_with("foreign authority")) CHECK(intruder.writes());
  }
  std::uint64_t newest = 0;
  for (const RobotCommand& command : pair.received) {
    CHECK(command.robot() == kGenuine);
    CHECK(command.sequence_number() == ++newest);  // each once: nothing replayed
  }
}

TEST_CASE("in clear the same sniffer and intruder read and forge", "[system][security]") {
  const std::string vendor = GENERATE("cyclonedds", "fastdds");
  CAPTURE(vendor);
  Sniffer sniffer;
  Pair pair(OnLoopback("cyclonedds"), OnLoopback("fastdds"));
  Peer intruder("in clear", vendor, OnLoopback(vendor));
  bool was_forged = false;
  CHECK(WaitUntil([&] {
    intruder.Write(1);
    pair.Exchange(std::chrono::milliseconds(100));  // its command may be overwritten
    for (const RobotCommand& command : pair.received)
      was_forged |= command.robot() == intruder.name();
    return was_forged && intruder.Read() > 0;
  }));
  sniffer.Stop();
  CHECK((!sniffer.allowed() || sniffer.CountWith(kGenuine) > 0));
  CHECK((!sniffer.allowed() || sniffer.CountWith(kRobot) > 0));
}

TEST_CASE("a certificate that was revoked or rotated no longer counts", "[system][security]") {
  const std::string of_sim = GENERATE("cyclonedds", "fastdds");
  const std::string of_planner = GENERATE("cyclonedds", "fastdds");
  CAPTURE(of_sim, of_planner);
  const Keystore keys;
  // A thief's copy, which no new list of revoked certificates reaches.
  const fs::path stolen = keys.path() / "stolen";
  fs::create_directories(stolen / "enclaves");
  fs::copy(keys.EnclaveFolder("planner", of_planner), stolen / "enclaves" / "planner");
  keystore::Rotate(keys.path() / "keys", {}, 10);
  bus::ParticipantOptions old = keys.Options("planner", of_planner);
  old.keystore = stolen;
  old.enclave = "/planner";
  Participant sim("sim", keys.Options("sim", of_sim));
  Subscriber<RobotCommand> commands(sim, bus::kRobotCommand, kRobot);
  Peer thief(kGenuine, of_planner, old);
  CHECK(thief.writes());
  CHECK_FALSE(Commands(commands, thief, std::chrono::seconds(2)));
  Peer planner(kGenuine, of_planner, keys.Options("planner", of_planner));
  CHECK(Commands(commands, planner, std::chrono::seconds(20)));
}

TEST_CASE("a program with security asked for does not start without one of its files",
          "[system][security]") {
  const std::string vendor = GENERATE("cyclonedds", "fastdds");
  const std::string file = GENERATE("identity_ca.cert.pem", "permissions_ca.cert.pem", "cert.pem",
                                    "key.pem", "governance.p7s", "permissions.p7s");
  CAPTURE(vendor, file);
  const Keystore keys;
  fs::remove(keys.EnclaveFolder("sim", vendor) / file);
  CHECK_THROWS_WITH(Participant("sim", keys.Options("sim", vendor)), Catch::Contains(file));
}

TEST_CASE("ROS_SECURITY_* say whether, from where and how strictly", "[system][security]") {
  struct Row {
    const char* enable;
    const char* keystore;  // "" = the keystore
    const char* strategy;
    const char* enclave;
    int exit_code;  // of a service that is stopped once it runs, or that ends by itself
  };
  const Row row = GENERATE(Row{"true", "", "Enforce", "/conav/h1/nhpm/cyclonedds", 0},
                           Row{"true", "", nullptr, "/conav/h1/nowhere", 1},
                           Row{"true", "", "Enforce", "/conav/h1/nowhere", 1},
                           Row{"true", "/nowhere", nullptr, nullptr, 1},
                           Row{"true", nullptr, nullptr, nullptr, 1},
                           Row{"true", "", "Permissive", "/conav/h1/nowhere", 0},
                           Row{"false", "", "Enforce", "/conav/h1/nowhere", 0});
  CAPTURE(row.enable, row.strategy ? row.strategy : "none", row.enclave ? row.enclave : "none");
  const Keystore keys;
  const std::string keystore = keys.path() / "keys";
  const ScopedVariable enable("ROS_SECURITY_ENABLE", row.enable);
  const ScopedVariable folder(
      "ROS_SECURITY_KEYSTORE",
      row.keystore == nullptr || *row.keystore != '\0' ? row.keystore : keystore.c_str());
  const ScopedVariable strategy("ROS_SECURITY_STRATEGY", row.strategy);
  const ScopedVariable enclave("ROS_SECURITY_ENCLAVE_OVERRIDE", row.enclave);
  const auto config =
      keys.Write("nhpm.yaml",
                 fmt::format("nhpm:\n  ros__parameters:\n    bus: {{vendor: cyclonedds, domain_id: "
                             "{}, interface: lo}}\n",
                             TestDomain()));
  RunningProgram service("conav-nhpm", "--config " + config.string(), keys.path() / "log");
  if (row.exit_code == 0) {
    REQUIRE(service.Prints("running"));
    service.Signal(SIGTERM);
  }
  CHECK(service.Wait().exit_code == row.exit_code);
}

}  // namespace
}  // namespace conav::test
