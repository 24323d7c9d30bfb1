// conav-hosts: writes what each host of a system needs, and checks it there.
#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <ctime>
#include <fstream>
#include <nlohmann/json.hpp>

#include "common/bus/backend.h"
#include "common/bus/network.h"
#include "common/bus/publisher.h"
#include "common/bus/ros_graph.h"
#include "common/bus/subscriber.h"
#include "common/cli/cli.h"
#include "common/runtime/file.h"
#include "common/runtime/log.h"
#include "common/runtime/text.h"
#include "common/runtime/threads.h"
#include "common/service/diagnostics.h"
#include "keystore/keystore.h"
#include "launcher/host_probe.h"
#include "launcher/hosts.h"

namespace conav::launcher {
namespace {

using namespace std::chrono_literals;
using std::chrono::steady_clock;

constexpr const char* kProgram = "conav hosts";
constexpr const char* kDoctor = "conav doctor hosts";
constexpr auto kAskPeriod = 250ms;

struct Arguments {
  std::filesystem::path file;
  std::filesystem::path out = "hosts";
  std::string host;
  double wait_s = 10.0;
  bool answer = false;
  std::filesystem::path json;  // "-" = standard output; empty = none
};

enum class Level { kOk, kWarning, kFailure };

constexpr std::string_view Name(Level level) {
  constexpr std::array<std::string_view, 3> kNames{"OK", "WARN", "FAIL"};
  return kNames[static_cast<std::size_t>(level)];
}

/// A row of the report.
struct Finding {
  Level level;
  std::string host;
  std::string check;
  std::string seen;
  std::string advice;  // empty when it is well
};

using Findings = std::vector<Finding>;

/// This host of the plan.
const Host& FindHost(const HostsPlan& plan, const std::string& name) {
  const std::string wanted = name.empty() ? bus::HostName() : keystore::HostFolder(name);
  for (const Host& host : plan.hosts) {
    if (keystore::HostFolder(host.name) == wanted) return host;
  }
  throw StartupError(fmt::format(
      "the file does not list this host, {}: name one of its hosts with --host", wanted));
}

Finding CheckAddress(const Host& host) {
  try {
    bus::ParticipantOptions options;
    options.interface = bus::ResolvePeer(host.address);
    bus::ResolveNetwork(options);
    return {Level::kOk, host.name, "address", host.address, ""};
  } catch (const StartupError& error) {
    return {Level::kFailure, host.name, "address", error.what(),
            "Correct address in hosts.yaml. DDS does not pass a NAT: use a VPN (docs/hosts.md)."};
  }
}

/// The domain's ports should not be among those that the kernel gives to other programs.
Finding CheckPorts(const Host& host, int domain) {
  const int first = bus::FirstPortOf(domain);
  Finding row{Level::kOk, host.name, "ports", fmt::format("UDP {} to {}", first, first + 249), ""};
  int low = 32768;
  int high = 60999;
  std::ifstream("/proc/sys/net/ipv4/ip_local_port_range") >> low >> high;
  if (first + 249 < low || first > high) return row;
  row.level = Level::kWarning;
  row.seen += fmt::format(": the kernel gives ports {} to {} to other programs", low, high);
  row.advice = fmt::format("Choose a domain_id of at most {}.", (low - 7650) / 250);
  return row;
}

/// SHA-256 of the authority's certificate; empty where it cannot be read.
std::string AuthorityOf(const HostsPlan& plan, const Host& host) {
  const auto file = std::filesystem::path(plan.bus.keystore) / "enclaves" / "conav" /
                    keystore::HostFolder(host.name);
  if (plan.bus.keystore.empty() || host.roles().empty()) return "";
  const auto text = ReadFile(file / host.roles().front() / std::string(Name(bus::kDefaultVendor)) /
                             "identity_ca.cert.pem");
  return text ? Sha256Hex(*text).substr(0, 16) : "";
}

std::string UtcIn(std::chrono::hours ahead) {
  const std::time_t time =
      std::chrono::system_clock::to_time_t(std::chrono::system_clock::now() + ahead);
  return UtcTime(time, "%Y-%m-%dT%H:%M:%S");
}

/// Of one enclave. `end`: the earliest so far.
void CheckEnclave(const bus::Enclave& enclave, std::string& end) {
  const auto read = [](const std::string& file) {
    auto text = ReadFile(file);
    return text ? *std::move(text) : throw StartupError(text.error().text);
  };
  const std::string certificate = read(enclave.certificate);
  const std::string authority = read(enclave.identity_ca);
  if (!keystore::IsSignedBy(certificate, authority)) {
    throw StartupError(enclave.name + " has a certificate of another authority");
  }
  for (const std::string& text : {certificate, authority}) {
    end = std::min(end, keystore::EndOf(text));
  }
  if (enclave.crl.empty()) return;
  const auto revoked = keystore::RevokedIn(read(enclave.crl));
  if (std::ranges::find(revoked, keystore::SerialOf(certificate)) != revoked.end()) {
    throw StartupError(enclave.name + " has a revoked certificate");
  }
}

Finding CheckKeys(const HostsPlan& plan, const Host& host) {
  Finding row{Level::kOk, host.name, "keys", "off", ""};
  if (plan.bus.keystore.empty()) return row;
  std::string end = "9999";
  try {
    for (const std::string& role : host.roles()) {
      for (const bus::Vendor vendor : bus::kVendors) {
        bus::ParticipantOptions options = plan.bus;
        options.enclave = EnclaveOf(host, role, vendor);
        CheckEnclave(*bus::FindEnclave(options), end);
      }
    }
    row.seen = "until " + end;
    if (end > UtcIn(24h * 30)) return row;
    row.level = end > UtcIn(0h) ? Level::kWarning : Level::kFailure;
    if (row.level == Level::kFailure) row.seen = "expired " + end;
  } catch (const StartupError& error) {
    row.level = Level::kFailure;
    row.seen = error.what();
  }
  row.advice = fmt::format(
      "Where the keystore is: conav keystore rotate {}, then conav hosts; copy what it wrote to "
      "all hosts and "
      "restart their services.",
      host.name);
  return row;
}

/// The services of the system as they answer on the bus, within the security of tools.
class BusProbe {
 public:
  /// Throws StartupError.
  BusProbe(const HostsPlan& plan, const Host& own)
      : participant_("conav_doctor", OptionsOf(plan, own)),
        reports_(participant_, bus::kDiagnostics),
        probes_(participant_, bus::kClockProbe) {}

  void Ask() {
    asked_.push_back(steady_clock::now().time_since_epoch());
    rosgraph_msgs::msg::Clock probe;
    probe.clock(RosWallTime(asked_.back()));
    bus::Send(probes_, probe);
  }

  void Take() {
    const std::chrono::duration<double> now = steady_clock::now().time_since_epoch();
    for (const auto& array : reports_.Take()) {
      for (const ReportedHealth& health : HealthOf(array)) {
        if (!health.clock || std::ranges::find(asked_, health.clock->asked) == asked_.end())
          continue;
        Answers& of = answers_[health.clock->host];
        of.processes.insert(health.process);
        of.clock.Add(std::chrono::duration<double>(health.clock->asked).count(),
                     health.clock->received_s, health.clock->sent_s, now.count());
      }
    }
    for (const bus::Event& event : participant_.TakeEvents()) {
      if (event.kind == bus::Event::Kind::kOtherSystem) other_systems_.insert(event.detail);
    }
  }

  struct Answers {
    std::set<std::string> processes;
    ClockOffset clock;  // against our monotonic time
  };
  /// By HostFolder().
  const std::map<std::string, Answers>& answers() const { return answers_; }
  const std::set<std::string>& other_systems() const { return other_systems_; }

 private:
  static bus::ParticipantOptions OptionsOf(const HostsPlan& plan, const Host& own) {
    bus::ParticipantOptions options = BusOf(plan, own);
    options.keystore = plan.bus.keystore;
    if (!options.keystore.empty()) options.enclave = EnclaveOf(own, "tools", *options.vendor);
    return bus::Resolve(options);
  }

  bus::Participant participant_;
  bus::Subscriber<diagnostic_msgs::msg::DiagnosticArray> reports_;
  bus::Publisher<rosgraph_msgs::msg::Clock> probes_;
  std::vector<std::chrono::nanoseconds> asked_;
  std::map<std::string, Answers> answers_;
  std::set<std::string> other_systems_;
};

Finding CheckServices(const Host& host, const BusProbe& probe) {
  const auto found = probe.answers().find(keystore::HostFolder(host.name));
  const std::set<std::string> seen =
      found == probe.answers().end() ? std::set<std::string>() : found->second.processes;
  Finding row{Level::kOk, host.name, "services",
              fmt::format("{} of {} answer on the bus{}{}", seen.size(), host.services.size(),
                          seen.empty() ? "" : ": ", Join(seen, ", ")),
              ""};
  if (seen.size() >= host.services.size()) return row;
  row.level = Level::kWarning;
  row.advice =
      "Start the others (systemctl status 'conav@*'), all with the files of the same hosts.yaml.";
  return row;
}

Finding CheckReach(const Host& host, const PeerReport& peer, bool answers_on_bus, int domain) {
  Finding row{Level::kOk, host.name, "reach", "", ""};
  if (const auto clock = peer.clock.best()) {
    row.seen = fmt::format("both ways, {:.1f} ms", clock->round_trip_s * 1e3);
    return row;
  }
  if (answers_on_bus) {
    row.seen = "its services answer on the bus";
    row.advice = "Run this command there at the same time to check the rest.";
    return row;
  }
  const bool is_there = peer.problem == "Connection refused";
  row.level = is_there ? Level::kWarning : Level::kFailure;
  row.seen = is_there ? "the host answers, but neither a doctor nor a service does"
                      : fmt::format("no answer from {}{}{}", host.address,
                                    peer.problem.empty() ? "" : ": ", peer.problem);
  row.advice = is_there ? "Run this command there at the same time, or with --answer."
                        : fmt::format(
                              "Check that it is up and in the same network or VPN, that this "
                              "command runs there at the "
                              "same time, and that firewalls let UDP {} to {} pass both ways.",
                              bus::FirstPortOf(domain), bus::FirstPortOf(domain + 1) - 1);
  return row;
}

Finding CheckMtu(const Host& host, const PeerReport& peer) {
  Finding row{Level::kOk, host.name, "mtu", "", ""};
  const std::size_t largest = peer.whole.empty() ? 0 : *peer.whole.rbegin();
  if (largest >= HostProbe::kBusDatagram) {
    row.seen = fmt::format("{} bytes in one piece", largest);
  } else if (peer.in_pieces.contains(HostProbe::kBusDatagram)) {
    row.level = Level::kWarning;
    row.seen =
        fmt::format("the bus's {} bytes go in pieces, {} in one", HostProbe::kBusDatagram, largest);
    row.advice =
        "A lost piece costs all of them. Give the interface, or the tunnel, an MTU of at least "
        "1428.";
  } else {
    row.level = Level::kFailure;
    row.seen =
        fmt::format("the bus's {} bytes do not arrive, {} do", HostProbe::kBusDatagram, largest);
    row.advice =
        fmt::format("Set the MTU of both interfaces to {}, or raise it on the way.", largest + 28);
  }
  return row;
}

Finding CheckMulticast(const Host& host, const PeerReport& peer, bool is_needed) {
  Finding row{Level::kOk, host.name, "multicast",
              peer.multicast ? "passes" : "does not pass; not needed", ""};
  if (peer.multicast || !is_needed) return row;
  return {
      Level::kFailure, host.name, "multicast", "does not pass",
      "Remove multicast: true from hosts.yaml, so that hosts find each other by their addresses."};
}

Finding CheckClock(const Host& host, double ahead_s, double error_s) {
  Finding row{Level::kOk, host.name, "clock",
              fmt::format("{:+.1f} ms (within {:.1f})", ahead_s * 1e3, error_s * 1e3), ""};
  if (std::abs(ahead_s) - error_s <= kClockLimitS) return row;
  row.level = Level::kWarning;
  row.advice =
      "apt-get install chrony on both hosts, then `chronyc makestep` on the one that is wrong.";
  return row;
}

Finding CheckEqual(const Host& host, const std::string& check, const std::string& theirs,
                   const std::string& ours, const std::string& advice) {
  if (theirs == ours) return {Level::kOk, host.name, check, ours.empty() ? "off" : ours, ""};
  return {Level::kFailure, host.name, check,
          fmt::format("{} there, {} here", theirs.empty() ? "off" : theirs,
                      ours.empty() ? "off" : ours),
          advice};
}

/// About another host.
Findings CheckPeer(const HostsPlan& plan, const Host& host, const PeerReport& peer,
                   const HostFacts& own, const BusProbe* bus, int domain) {
  const BusProbe::Answers* answers = nullptr;
  if (bus != nullptr) {
    const auto found = bus->answers().find(keystore::HostFolder(host.name));
    if (found != bus->answers().end()) answers = &found->second;
  }
  Findings rows{CheckReach(host, peer, answers != nullptr, domain)};
  if (const auto clock = peer.clock.best()) {
    rows.push_back(CheckMtu(host, peer));
    rows.push_back(CheckMulticast(host, peer, plan.multicast));
    rows.push_back(CheckClock(host, clock->offset_s, clock->round_trip_s / 2.0));
    rows.push_back(CheckEqual(
        host, "version", peer.facts.version, own.version,
        "Install the same version on all hosts: others may not understand its messages."));
    rows.push_back(CheckEqual(host, "hosts.yaml", peer.facts.plan, own.plan,
                              "Run conav hosts again and copy what it writes to all hosts."));
    rows.push_back(CheckEqual(host, "authority", peer.facts.authority, own.authority,
                              "Make the keys of all hosts with one keystore."));
  } else if (answers != nullptr && answers->clock.best()) {
    const std::chrono::duration<double> monotonic = steady_clock::now().time_since_epoch();
    const auto clock = *answers->clock.best();
    rows.push_back(CheckClock(host, clock.offset_s - (WallSeconds() - monotonic.count()),
                              clock.round_trip_s / 2.0));
  }
  if (bus != nullptr) rows.push_back(CheckServices(host, *bus));
  return rows;
}

Finding CheckSystem(const Host& own, const BusProbe& bus, int domain, const std::string& system) {
  if (bus.other_systems().empty()) {
    return {Level::kOk, own.name, "domain", fmt::format("{}: no other system", domain), ""};
  }
  return {
      Level::kWarning, own.name, "domain",
      fmt::format("{}: other systems are there: {}", domain, Join(bus.other_systems(), ", ")),
      fmt::format(
          "They ignore each other's messages. Give one of them another domain_id; if it is of {}, "
          "give its services that bus.system.",
          system)};
}

/// Everything, within `wait`.
Findings Examine(const HostsPlan& plan, const Host& own, const HostFacts& facts, double wait_s) {
  const bus::ParticipantOptions resolved = [&] {
    bus::ParticipantOptions options = plan.bus;
    options.keystore.clear();
    return bus::Resolve(options);
  }();
  const int domain = resolved.domain_id;
  Findings rows{CheckAddress(own), CheckPorts(own, domain), CheckKeys(plan, own)};
  std::optional<BusProbe> bus;
  try {
    bus.emplace(plan, own);
  } catch (const StartupError& error) {
    const bool lacks_tools = !plan.bus.keystore.empty() && !own.tools;
    rows.push_back({lacks_tools ? Level::kOk : Level::kFailure, own.name, "bus",
                    lacks_tools ? "skipped: this host has no keys for tools" : error.what(),
                    lacks_tools ? "To look there, set tools: true for it in hosts.yaml."
                                : "Correct interface or bus in hosts.yaml."});
  }
  std::optional<HostProbe> probe;
  try {
    probe.emplace(plan, facts, domain);
  } catch (const StartupError& error) {
    rows.push_back({Level::kFailure, own.name, "doctor", error.what(),
                    "End the other doctor of this domain, or correct interface."});
    return rows;
  }
  const auto end = steady_clock::now() + Seconds(wait_s);
  while (steady_clock::now() < end && !ProcessStopToken().stop_requested()) {
    probe->Ask();
    if (bus) bus->Ask();
    const auto next = steady_clock::now() + kAskPeriod;
    while (steady_clock::now() < next) {
      probe->Receive(20ms);
      if (bus) bus->Take();
    }
  }
  if (bus) rows.push_back(CheckSystem(own, *bus, domain, resolved.system));
  if (bus) rows.push_back(CheckServices(own, *bus));
  for (const Host& host : plan.hosts) {
    if (host.name == own.name) continue;
    std::ranges::move(
        CheckPeer(plan, host, probe->peers().at(host.name), facts, bus ? &*bus : nullptr, domain),
        std::back_inserter(rows));
  }
  return rows;
}

int RunDoctor(const Arguments& arguments) {
  const HostsPlan plan = LoadHosts(arguments.file);
  const Host& own = FindHost(plan, arguments.host);
  const HostFacts facts{own.name, CONAV_VERSION, plan.checksum().substr(0, 16),
                        AuthorityOf(plan, own)};
  if (arguments.answer) {
    bus::ParticipantOptions options = plan.bus;
    options.keystore.clear();
    HostProbe probe(plan, facts, bus::Resolve(options).domain_id);
    fmt::print("{}: answers other hosts' doctors until Ctrl-C\n", own.name);
    std::fflush(stdout);
    while (!ProcessStopToken().stop_requested()) probe.Receive(100ms);
    return 0;
  }
  const Findings rows = Examine(plan, own, facts, arguments.wait_s);
  nlohmann::ordered_json document{{"host", own.name}, {"checks", nlohmann::ordered_json::array()}};
  std::FILE* output = arguments.json == "-" ? stderr : stdout;
  bool failed = false;
  for (const Finding& row : rows) {
    fmt::print(output, "{:<5} {:<12} {:<11} {}\n", Name(row.level), row.host, row.check, row.seen);
    if (!row.advice.empty()) fmt::print(output, "{:<31}{}\n", "", row.advice);
    document["checks"].push_back({{"level", Name(row.level)},
                                  {"host", row.host},
                                  {"check", row.check},
                                  {"seen", row.seen},
                                  {"advice", row.advice}});
    failed |= row.level == Level::kFailure;
  }
  const int written = ExitCode(kDoctor, WriteJsonOutput(arguments.json, document));
  return failed ? 1 : written;
}

int RunWrite(const Arguments& arguments) {
  const HostsPlan plan = LoadHosts(arguments.file);
  WriteHosts(plan, arguments.out);
  return ExitCode(kProgram, WriteStandardOutput(NextSteps(plan, arguments.out)));
}

constexpr const char* kAboutWrite = R"(Writes what each host of a system needs, from one file.

For each host a folder with the configuration of its services (peers, domain, interface, system, keys) and a
hosts.yaml for the doctor, as /etc/conav has them there; prints how to copy them and which units to enable.
The example is deploy/config/hosts.yaml.

Exit codes: 0 written; 1 the file is wrong, which is explained by key and line; 2 wrong use.)";

constexpr const char* kAboutDoctor =
    R"(Checks, on a host of a hosts.yaml, whether the system can run there.

Looks at this host's address, ports and keys, at the services that answer on the bus, and at each other host:
whether it can be reached, by what sizes of datagrams, by multicast, how its clock, version, hosts.yaml and authority
of keys compare. For the latter the same command has to run there at the same time, or with --answer.

Exit codes: 0 nothing fails; 1 something does, and the row says what to do; 2 wrong use.

Examples:
  conav doctor hosts /etc/conav/hosts.yaml --answer     on the other hosts
  conav doctor hosts /etc/conav/hosts.yaml)";

}  // namespace
}  // namespace conav::launcher

int main(int argc, char** argv) {
  using namespace conav::launcher;
  CLI::App app{"Several hosts", "conav"};
  app.require_subcommand(1);
  Arguments arguments;
  CLI::App& write = *app.add_subcommand("hosts", kAboutWrite);
  write.add_option("FILE", arguments.file, "The hosts and their services")->required();
  conav::AddShown(write, "--out", arguments.out, "Folder for the hosts' folders");
  CLI::App& doctor = *app.add_subcommand("doctor", "Checks a system")->require_subcommand(1);
  CLI::App& hosts = *doctor.add_subcommand("hosts", kAboutDoctor);
  hosts.add_option("FILE", arguments.file, "The hosts and their services")->required();
  hosts.add_option("--host", arguments.host, "Which of the file's hosts this is [`hostname`]");
  hosts.add_option("--wait", arguments.wait_s, "Seconds for the others to answer")
      ->check(conav::Between(1.0, 600.0))
      ->capture_default_str();
  hosts.add_flag("--answer", arguments.answer,
                 "Only answer the doctors of other hosts, until Ctrl-C");
  hosts.add_option("--json", arguments.json, "Write the rows, or -");
  if (const auto ended = conav::Parse(app, argc, argv)) return *ended;
  const char* program = write.parsed() ? kProgram : kDoctor;
  if (const int code =
          conav::CheckFiles(program, {{"FILE", arguments.file}}, {{"--json", arguments.json}});
      code != 0)
    return code;
  conav::log::SetMinimumLevel(conav::log::Level::kWarning);
  conav::InstallStopSignals();
  try {
    return write.parsed() ? RunWrite(arguments) : RunDoctor(arguments);
  } catch (const std::exception& error) {
    return conav::Failed(program, {conav::ErrorCode::kIo, error.what()});
  }
}
