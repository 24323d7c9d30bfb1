#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/bus/participant.h"
#include "common/runtime/config.h"

namespace conav::launcher {

/// A service on a host.
struct HostService {
  std::string name;    // as of its unit: "simulated-operator"
  std::string config;  // its whole configuration, a YAML document
};

struct Host {
  std::string name;                   // as `hostname` prints it there
  std::string address;                // at which the other hosts reach it
  std::string interface;              // towards them; empty = the vendor's choice
  std::optional<bus::Vendor> vendor;  // empty = the system's
  /// With DDS security: whether it has keys for tools (conav doctor, ros2, RViz), and other topics that its
  /// programs may use, those of a driver's robot.
  bool tools = false;
  std::vector<std::string> topics;
  std::vector<HostService> services;
  /// That it simulates or drives; only of these may it send anything, unless it runs other services, too.
  std::vector<std::string> robots;

  /// Of its services: "simulated_operator".
  std::vector<std::string> roles() const;
  void Visit(ConfigReader& reader);
};

/// The hosts of one system: a hosts.yaml. deploy/config/hosts.yaml is an example.
struct HostsPlan {
  /// Of all services, less what differs from host to host: no interface, no peers, no enclave. The keystore is the
  /// folder on this machine; empty = no DDS security.
  bus::ParticipantOptions bus;
  bool multicast = false;  // instead of peers
  std::vector<Host> hosts;

  /// Whether a file of another host describes the same system.
  std::string checksum() const;
  void Visit(ConfigReader& reader);
};

/// How the programs of a host take part in DDS: its keystore is the copy in its own folder.
bus::ParticipantOptions BusOf(const HostsPlan& plan, const Host& host);

/// Of one of its roles; a host's name here need not be what `hostname` prints.
std::string EnclaveOf(const Host& host, const std::string& role, bus::Vendor vendor);

/// Reads a hosts.yaml. Throws StartupError with file, key and line for settings that a service would refuse, and for
/// a name, address or robot that occurs twice.
HostsPlan LoadHosts(const std::filesystem::path& file);

/// Writes into out/<host> what /etc/conav holds there: a file for each service, its keys, and a hosts.yaml without the
/// services' settings for `conav doctor hosts`. Adds hosts to the keystore that it lacks or has with
/// other services, and makes it where there is none. Throws StartupError.
void WriteHosts(const HostsPlan& plan, const std::filesystem::path& out);

/// What to do next, with the units of each host.
std::string NextSteps(const HostsPlan& plan, const std::filesystem::path& out);

}  // namespace conav::launcher
