#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "keystore/role_topics.h"

/// A folder with the keys and permissions of DDS security, laid out as SROS2 does:
///
///   private/ca.key.pem, public/ca.cert.pem       the authority, of identities and of permissions
///   private/conav_hosts/<host>.yaml              what was added for a host
///   public/crl.pem                               certificates that no longer count
///   enclaves/governance.{xml,p7s}
///   enclaves/conav/<host>/<role>/<vendor>/       an enclave: certificate, key, permissions, and copies of
///                                                the shared files, so that it can be moved by itself
///
/// Each role has an enclave for each DDS vendor: Cyclone DDS must begin the handshake with Fast DDS 2.9, and
/// the certificate's subject decides who begins.
///
/// Files are 0600, folders 0700. All functions throw StartupError that names the file or the host.
namespace conav::keystore {

struct Host {
  std::string name;  // letters, digits and _, as in a ROS 2 enclave
  std::vector<std::string> roles;
  GrantOptions grant;
};

/// `days`: until the authority, and so all, ends.
void Init(const std::filesystem::path& folder, int days);
/// A host that is there gets these roles and options instead of those it had, and new keys.
void Add(const std::filesystem::path& folder, const Host& host, int days);
/// New keys, certificates and permissions for these hosts, none = for all; those before no longer count.
void Rotate(const std::filesystem::path& folder, const std::vector<std::string>& hosts, int days);
/// The certificates of a host no longer count; its enclaves are removed.
void Revoke(const std::filesystem::path& folder, const std::string& host);

/// By name.
std::vector<Host> Hosts(const std::filesystem::path& folder);

/// "robot-1.lan" -> "robot_1_lan", as a conav of that host looks for its enclaves.
std::string HostFolder(const std::string& host);

}  // namespace conav::keystore
