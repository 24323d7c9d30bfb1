#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

// One user: the program; tests and the benchmark of the bus make keystores, too.

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

// --- roles: role_topics.cc ---
//
// What each program of conav may publish and subscribe to, by the table of topics and that of services.

/// Of the launcher, of `conav doctor robot` and of tools (RViz, `ros2`, `conav doctor ros`) there is one
/// each; the others are services. The doctor drives and stops robots.
inline constexpr std::array<std::string_view, 10> kRoles{
    "sim",      "driver", "nhpm", "operator", "planner", "recorder", "simulated_operator",
    "launcher", "doctor", "tools"};

/// Patterns of DDS topic names; "never" comes first.
struct Grant {
  std::vector<std::string> publish;
  std::vector<std::string> subscribe;
  std::vector<std::string> never_publish;
  std::vector<std::string> never_subscribe;
};

struct GrantOptions {
  /// What the role sends about a robot, and what is sent to a robot, is of these only; none = of all.
  std::vector<std::string> robots;
  /// ROS names of other topics and actions that it may use: those of a driver's robot.
  std::vector<std::string> topics;
  bool operator==(const GrantOptions&) const = default;
};

/// The operator, the recorder, the launcher, the doctor and tools may read every topic.
Grant GrantOf(std::string_view role, const GrantOptions& options);

/// The roles that the side of a "from -> to" in the table of topics names. Throws StartupError for a word
/// that it does not know.
std::vector<std::string_view> RolesIn(std::string_view side);

/// DDS security's permissions of one subject, valid until `end` ("2036-11-24T00:00:00"), in the domains 0 to
/// 230, the last that Cyclone DDS accepts here.
std::string PermissionsXml(const Grant& grant, const std::string& enclave,
                           const std::string& subject, const std::string& end);

/// SROS2's default, everything authenticated, encrypted and subject to permissions, without the signature of
/// whole RTPS packets on top: with it about one in seven mixed systems had a Fast DDS reader that never got the
/// messages of a Cyclone DDS writer, without it none of 33.
std::string GovernanceXml();

// --- the folder: keystore.cc ---

struct Host {
  std::string name;  // letters, digits and _, as in a ROS 2 enclave
  std::vector<std::string> roles;
  GrantOptions grant;
  bool operator==(const Host&) const = default;
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

// --- certificates: certificates.cc ---
//
// X.509 certificates, signatures and revocation lists as DDS security wants them, by OpenSSL: ECDSA on
// P-256 with SHA-256, all texts PEM. Pure. Errors: StartupError with OpenSSL's reason.

struct Identity {
  std::string certificate;
  std::string key;
};

/// Certificates count from a day before now, since the clocks of hosts differ.
Identity MakeAuthority(const std::string& common_name, int days);

/// A certificate of `common_name`, with `unit` as OU, by `authority`.
Identity MakeIdentity(const std::string& common_name, const std::string& unit,
                      const Identity& authority, int days);

/// "OU=2,CN=/conav/host/sim/cyclonedds": the subject as permissions name it (RFC 2253).
std::string SubjectOf(const std::string& certificate);

/// The first byte of the SHA-256 of the subject in DER. Both DDS vendors derive the participant's GUID
/// from it.
std::uint8_t SubjectHash(const std::string& certificate);

/// Whether the key of `authority`, a certificate, has signed it.
bool IsSignedBy(const std::string& certificate, const std::string& authority);

/// Hexadecimal.
std::string SerialOf(const std::string& certificate);

/// The time of its end, "2036-11-24T00:00:00" UTC.
std::string EndOf(const std::string& certificate);

/// `text` with its detached S/MIME signature, as governance and permissions are sent.
std::string Sign(const std::string& text, const Identity& authority);

/// The serials of `list`, which may be empty.
std::vector<std::string> RevokedIn(const std::string& list);

/// The revocation list of these serials. It has no end of its own before that of the authority: a list that
/// runs out would stop all.
std::string MakeRevocationList(const std::vector<std::string>& serials, const Identity& authority);

}  // namespace conav::keystore
