#include "launcher/hosts.h"

#include <fmt/core.h>

#include <algorithm>
#include <map>

#include "common/runtime/file.h"
#include "common/runtime/text.h"
#include "keystore/keystore.h"
#include "nhpm/config.h"
#include "operator/config.h"
#include "operator/recording/config.h"
#include "operator/simulated/config.h"
#include "planner/config.h"
#include "robot/driver/config.h"
#include "sim/config.h"

namespace conav::launcher {
namespace {

namespace fs = std::filesystem;

constexpr const char* kHostKeystore = "keystore";  // beside its files
constexpr int kCertificateDays = 3650;
constexpr int kAuthorityDays = 7300;

std::string SectionOf(std::string service) {
  std::ranges::replace(service, '-', '_');
  return service;
}

/// A service's settings in a hosts.yaml, before the bus of its host is known.
struct Settings {
  std::string node_name;            // where two processes must not share it; else empty
  std::vector<std::string> robots;  // that it simulates or drives
};

/// Reads the settings with the service's own struct, and writes them as it reads them.
template <class Config>
Settings Complete(HostService& service, const YAML::Node& node, const std::string& path,
                  const bus::ParticipantOptions& bus) {
  Config config;
  ReadConfig(node, path, config);
  config.bus = bus;
  service.config = DumpConfig(SectionOf(service.name), config);
  Settings settings;
  if constexpr (requires { config.name; }) settings.node_name = config.name;
  if constexpr (std::is_same_v<Config, sim::SimConfig>) settings.robots = config.robots;
  if constexpr (std::is_same_v<Config, robot::DriverConfig>) settings.robots = {config.robot};
  return settings;
}

using Completer = Settings (*)(HostService&, const YAML::Node&, const std::string&,
                               const bus::ParticipantOptions&);

/// Null for an unknown name.
/// By service.
const std::map<std::string, Completer>& Completers() {
  static const std::map<std::string, Completer> known{
      {"sim", Complete<sim::SimConfig>},
      {"driver", Complete<robot::DriverConfig>},
      {"nhpm", Complete<nhpm::NhpmConfig>},
      {"operator", Complete<operators::OperatorConfig>},
      {"planner", Complete<planner::PlannerConfig>},
      {"recorder", Complete<recorder::RecorderConfig>},
      {"simulated-operator", Complete<operators::SimulatedOperatorConfig>}};
  return known;
}

[[noreturn]] void Refuse(const std::string& path, const std::string& what, const YAML::Node& at) {
  throw StartupError(fmt::format("{} {} (line {})", path, what, at.Mark().line + 1));
}

/// The entries of a mapping, whose names are not repeated.
std::vector<std::pair<std::string, YAML::Node>> EntriesOf(const YAML::Node& node,
                                                          const std::string& path) {
  if (!node.IsMap() || node.size() == 0) Refuse(path, "is not a mapping of names", node);
  std::vector<std::pair<std::string, YAML::Node>> entries;
  for (const auto& entry : node) {
    const auto name = entry.first.as<std::string>("");
    if (std::ranges::find(entries, name, [](const auto& known) { return known.first; }) !=
        entries.end()) {
      Refuse(path, fmt::format("has {} twice", name), entry.first);
    }
    entries.emplace_back(name, entry.second);
  }
  return entries;
}

/// What must differ from host to host: who has it, by kind and name.
class Owners {
 public:
  void Claim(const std::string& what, const std::string& path, const YAML::Node& at) {
    const auto [owner, is_new] = owners_.try_emplace(what, path);
    if (!is_new) Refuse(path, fmt::format("has {}, as {} has", what, owner->second), at);
  }

 private:
  std::map<std::string, std::string> owners_;
};

/// The file while it is read.
class HostsReader {
 public:
  explicit HostsReader(fs::path file) : file_(std::move(file)) {
    const auto document = ReadYamlFile(file_);
    if (!document) throw StartupError(document.error().text);
    document_ = *document;
    if (!document_["hosts"]) throw StartupError(file_.string() + ": no hosts");
    ReadConfig(document_, file_.string(), plan_);
  }

  HostsPlan Read() {
    const std::string path = file_.string() + ": hosts";
    for (const auto& [name, node] : EntriesOf(document_["hosts"], path)) {
      AddHost(name, node, path + "." + name);
    }
    for (Host& host : plan_.hosts) {
      AddServices(host, document_["hosts"][host.name]["services"], path + "." + host.name,
                  BusOf(plan_, host));
    }
    if (!plan_.bus.keystore.empty()) {
      plan_.bus.keystore = (file_.parent_path() / plan_.bus.keystore).lexically_normal().string();
    }
    return std::move(plan_);
  }

 private:
  void AddHost(const std::string& name, const YAML::Node& node, const std::string& path) {
    const auto allowed = [](char c) {
      return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '-' || c == '.' || c == '_';
    };
    if (name.empty() || name.front() == '.' || name.size() > 64 ||
        !std::ranges::all_of(name, allowed)) {
      Refuse(path, "is not the name of a host", node);
    }
    Host host;
    ReadConfig(node, path, host);
    host.name = name;
    if (host.address.empty()) Refuse(path, "has no address", node);
    owners_.Claim("address " + host.address, path, node["address"]);
    owners_.Claim("the keys' folder " + keystore::HostFolder(name), path, node);
    plan_.hosts.push_back(std::move(host));
  }

  /// `node`: a list of names, or a mapping of names to settings or to the file that has them.
  void AddServices(Host& host, const YAML::Node& node, const std::string& host_path,
                   const bus::ParticipantOptions& bus) {
    if (!node || node.IsNull()) return;
    if (node.IsSequence()) {
      for (const YAML::Node& name : node) {
        AddService(host, name.as<std::string>(""), YAML::Node(), name, host_path, bus);
      }
      return;
    }
    for (const auto& [name, settings] : EntriesOf(node, host_path + ".services")) {
      AddService(host, name, settings, settings, host_path, bus);
    }
  }

  void AddService(Host& host, const std::string& name, const YAML::Node& settings,
                  const YAML::Node& at, const std::string& host_path, bus::ParticipantOptions bus) {
    if (!bus.keystore.empty()) bus.enclave = EnclaveOf(host, SectionOf(name), *bus.vendor);
    std::string path = fmt::format("{}.services.{}", host_path, name);
    const auto complete = Completers().find(name);
    if (complete == Completers().end()) Refuse(path, "is not a service of conav", at);
    owners_.Claim(name + " on " + host.name, path, at);
    YAML::Node values = settings;
    if (settings.IsScalar()) {
      const fs::path file = file_.parent_path() / settings.as<std::string>();
      values = LoadParameters(file, SectionOf(name));
      values.remove("bus");
      path = fmt::format("{}: {}", file.string(), SectionOf(name));
    } else if (settings.IsMap() && settings["bus"]) {
      Refuse(path, "has a bus; write it once, at the top of the file", settings["bus"]);
    }
    HostService& service = host.services.emplace_back(HostService{name, ""});
    const Settings known = complete->second(service, values, path, bus);
    if (!known.node_name.empty()) owners_.Claim("the name " + known.node_name, path, at);
    for (const std::string& robot : known.robots) {
      owners_.Claim("robot " + robot, path, at);
      host.robots.push_back(robot);
    }
  }

  fs::path file_;
  YAML::Node document_;
  HostsPlan plan_;
  Owners owners_;
};

void Write(const fs::path& file, const std::string& text) {
  if (const auto written = WriteSecretFile(file, text); !written) {
    throw StartupError(written.error().text);
  }
}

/// The file without the services' settings, which may hold secrets of other hosts.
std::string Outline(const HostsPlan& plan) {
  YAML::Node outline;
  bus::ParticipantOptions bus = plan.bus;
  if (!bus.keystore.empty()) bus.keystore = kHostKeystore;
  outline["bus"] = Emitted(bus);
  outline["multicast"] = plan.multicast;
  for (const Host& host : plan.hosts) {
    YAML::Node node = Emitted(host);
    YAML::Node services(YAML::NodeType::Sequence);
    for (const HostService& service : host.services) services.push_back(service.name);
    node["services"] = services;
    outline["hosts"][host.name] = node;
  }
  return YAML::Dump(outline) + "\n";
}

/// Keys for each host, and its copies of them.
void WriteKeys(const HostsPlan& plan, const fs::path& out) {
  const fs::path folder = plan.bus.keystore;
  if (!fs::exists(folder / "private")) keystore::Init(folder, kAuthorityDays);
  const std::vector<keystore::Host> known = keystore::Hosts(folder);
  for (const Host& host : plan.hosts) {
    keystore::Host wanted{keystore::HostFolder(host.name), host.roles(), {{}, host.topics}};
    const auto is_of_robot = [](const HostService& service) {
      return service.name == "sim" || service.name == "driver";
    };
    if (std::ranges::all_of(host.services, is_of_robot)) wanted.grant.robots = host.robots;
    if (std::ranges::find(known, wanted) == known.end()) {
      keystore::Add(folder, wanted, kCertificateDays);
    }
  }
  // After the last addition, which may revoke keys of another host.
  for (const Host& host : plan.hosts) {
    const fs::path enclaves = fs::path("enclaves") / "conav" / keystore::HostFolder(host.name);
    const fs::path target = out / host.name / kHostKeystore / enclaves;
    fs::remove_all(target);
    fs::create_directories(target.parent_path());
    fs::copy(folder / enclaves, target, fs::copy_options::recursive);
  }
}

}  // namespace

std::vector<std::string> Host::roles() const {
  std::vector<std::string> roles;
  for (const HostService& service : services) roles.push_back(SectionOf(service.name));
  if (tools) roles.emplace_back("tools");
  return roles;
}

void Host::Visit(ConfigReader& reader) {
  reader.Field("address", address);
  reader.Field("interface", interface);
  reader.Choice("vendor", vendor, bus::kVendors);
  reader.Field("tools", tools);
  reader.Field("topics", topics);
  YAML::Node apart;  // by HostsReader
  if (reader.reading()) reader.Field("services", apart);
}

void HostsPlan::Visit(ConfigReader& reader) {
  reader.Section("bus", bus);
  reader.Field("multicast", multicast);
  if (!bus.interface.empty() || !bus.peers.empty() || !bus.enclave.empty()) {
    reader.Refuse("bus", "has what follows from the hosts: interface, peers or enclave");
  }
  YAML::Node apart;  // by HostsReader
  if (reader.reading()) reader.Field("hosts", apart);
}

bus::ParticipantOptions BusOf(const HostsPlan& plan, const Host& host) {
  bus::ParticipantOptions bus = plan.bus;
  bus.interface = host.interface;
  if (host.vendor) bus.vendor = host.vendor;
  if (!bus.keystore.empty()) {
    bus.keystore = kHostKeystore;
    bus.vendor = bus.vendor.value_or(bus::kDefaultVendor);
  }
  // Own addresses are no harm, so all have the same ones.
  for (const Host& peer : plan.hosts) {
    if (!plan.multicast) bus.peers.push_back(peer.address);
  }
  return bus;
}

std::string EnclaveOf(const Host& host, const std::string& role, bus::Vendor vendor) {
  return fmt::format("/conav/{}/{}/{}", keystore::HostFolder(host.name), role, Name(vendor));
}

std::string HostsPlan::checksum() const { return Sha256Hex(Outline(*this)); }

HostsPlan LoadHosts(const fs::path& file) { return HostsReader(file).Read(); }

void WriteHosts(const HostsPlan& plan, const fs::path& out) {
  for (const Host& host : plan.hosts) {
    fs::create_directories(out / host.name);
    // Of services that have moved to another host.
    for (const auto& [service, complete] : Completers()) {
      fs::remove(out / host.name / (service + ".yaml"));
    }
    for (const HostService& service : host.services) {
      Write(out / host.name / (service.name + ".yaml"), service.config);
    }
    Write(out / host.name / "hosts.yaml", Outline(plan));
  }
  if (!plan.bus.keystore.empty()) WriteKeys(plan, out);
}

std::string NextSteps(const HostsPlan& plan, const fs::path& out) {
  std::string text;
  for (const Host& host : plan.hosts) {
    std::vector<std::string> units;
    for (const HostService& service : host.services) units.push_back("conav@" + service.name);
    text +=
        fmt::format("{0} ({1}{2}{3})\n  rsync -a {4}/ {0}:/etc/conav/\n", host.name, host.address,
                    host.interface.empty() ? "" : ", ", host.interface, (out / host.name).string());
    if (!units.empty()) text += fmt::format("  systemctl enable --now {}\n", Join(units, " "));
  }
  return text + "Then, on all of them at the same time: conav doctor hosts /etc/conav/hosts.yaml\n";
}

}  // namespace conav::launcher
