#include "keystore/keystore.h"

#include <sys/stat.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <iterator>

#include "common/bus/participant.h"
#include "common/bus/ros_graph.h"
#include "common/runtime/config.h"
#include "common/runtime/file.h"

namespace conav::keystore {
namespace {

namespace fs = std::filesystem;

/// New files are for their owner only while it lives.
class OwnerOnly {
 public:
  OwnerOnly() : before_(umask(S_IRWXG | S_IRWXO)) {}
  ~OwnerOnly() { umask(before_); }
  OwnerOnly(const OwnerOnly&) = delete;
  OwnerOnly& operator=(const OwnerOnly&) = delete;

 private:
  mode_t before_;
};

std::string Read(const fs::path& file) {
  auto text = ReadFile(file);
  if (!text) throw StartupError(text.error().text);
  return *std::move(text);
}

void Write(const fs::path& file, const std::string& text) {
  fs::create_directories(file.parent_path());
  if (const auto written = WriteFile(file, text); !written)
    throw StartupError(written.error().text);
}

void Link(const fs::path& link, const char* target) {
  fs::remove(link);
  fs::create_symlink(target, link);
}

fs::path RecordOf(const fs::path& folder, const std::string& host) {
  return folder / "private" / "conav_hosts" / (host + ".yaml");
}
fs::path EnclavesOf(const fs::path& folder, const std::string& host) {
  return folder / "enclaves" / "conav" / host;
}

/// Files that one of these verbs leaves, read at its begin.
struct Authority {
  explicit Authority(const fs::path& folder)
      : identity{Read(folder / "public" / "ca.cert.pem"), Read(folder / "private" / "ca.key.pem")},
        governance(Read(folder / "enclaves" / "governance.p7s")),
        revoked(RevokedIn(Read(folder / "public" / "crl.pem"))) {}

  Identity identity;
  std::string governance;
  std::vector<std::string> revoked;
};

/// All certificates below a host's folder.
void RevokeAll(const fs::path& host_folder, Authority& authority) {
  if (!fs::exists(host_folder)) return;
  for (const auto& entry : fs::recursive_directory_iterator(host_folder)) {
    if (entry.path().filename() == "cert.pem") {
      authority.revoked.push_back(SerialOf(Read(entry.path())));
    }
  }
}

/// Into every enclave that there is.
void WriteRevocationList(const fs::path& folder, const Authority& authority) {
  const std::string list = MakeRevocationList(authority.revoked, authority.identity);
  Write(folder / "public" / "crl.pem", list);
  for (const auto& entry : fs::recursive_directory_iterator(folder / "enclaves")) {
    if (entry.path().filename() == "key.pem") Write(entry.path().parent_path() / "crl.pem", list);
  }
}

/// Draws subjects until the vendor begins the handshakes that it should: that of the lower hash does.
Identity MakeIdentityFor(bus::Vendor vendor, const std::string& enclave, const Identity& authority,
                         int days) {
  constexpr std::uint8_t kMiddle = 0x80;
  for (int salt = 0;; ++salt) {
    Identity identity = MakeIdentity(enclave, std::to_string(salt), authority, days);
    const bool is_low = SubjectHash(identity.certificate) < kMiddle;
    if (is_low == (vendor == bus::Vendor::kCycloneDds)) return identity;
  }
}

void WriteEnclave(const fs::path& folder, const Host& host, const std::string& role,
                  bus::Vendor vendor, const Authority& authority, int days) {
  const std::string name = fmt::format("/conav/{}/{}/{}", host.name, role, Name(vendor));
  const fs::path enclave = folder / "enclaves" / fs::path(name).relative_path();
  const Identity identity = MakeIdentityFor(vendor, name, authority.identity, days);
  const std::string permissions =
      PermissionsXml(GrantOf(role, host.grant), name, SubjectOf(identity.certificate),
                     EndOf(authority.identity.certificate));
  Write(enclave / "key.pem", identity.key);
  Write(enclave / "cert.pem", identity.certificate);
  Write(enclave / "identity_ca.cert.pem", authority.identity.certificate);
  Write(enclave / "permissions_ca.cert.pem", authority.identity.certificate);
  Write(enclave / "governance.p7s", authority.governance);
  Write(enclave / "permissions.xml", permissions);
  Write(enclave / "permissions.p7s", Sign(permissions, authority.identity));
}

void WriteHost(const fs::path& folder, const Host& host, Authority& authority, int days) {
  RevokeAll(EnclavesOf(folder, host.name), authority);
  fs::remove_all(EnclavesOf(folder, host.name));
  for (const std::string& role : host.roles) {
    for (const bus::Vendor vendor : bus::kVendors) {
      WriteEnclave(folder, host, role, vendor, authority, days);
    }
  }
  YAML::Node record;
  record["services"] = host.roles;
  record["robots"] = host.grant.robots;
  record["topics"] = host.grant.topics;
  Write(RecordOf(folder, host.name), YAML::Dump(record) + "\n");
}

Host ReadHost(const fs::path& folder, const std::string& name) {
  const fs::path file = RecordOf(folder, name);
  if (!fs::exists(file)) {
    throw StartupError(fmt::format("host {} is not in keystore {}", name, folder.string()));
  }
  const auto record = ReadYamlFile(file);
  if (!record) throw StartupError(record.error().text);
  using Strings = std::vector<std::string>;
  try {
    return {name,
            (*record)["services"].as<Strings>(),
            {(*record)["robots"].as<Strings>(), (*record)["topics"].as<Strings>()}};
  } catch (const YAML::Exception& error) {
    throw StartupError(fmt::format("{}: {}", file.string(), error.what()));
  }
}

}  // namespace

std::string HostFolder(const std::string& host) { return bus::RosName(host); }

void Init(const fs::path& folder, int days) {
  const OwnerOnly owner_only;
  if (fs::exists(folder / "private")) {
    throw StartupError(folder.string() + " is a keystore already");
  }
  const Identity authority = MakeAuthority("conav", days);
  Write(folder / "private" / "ca.key.pem", authority.key);
  Write(folder / "public" / "ca.cert.pem", authority.certificate);
  for (const char* kind : {"identity_ca", "permissions_ca"}) {
    Link(folder / "private" / fmt::format("{}.key.pem", kind), "ca.key.pem");
    Link(folder / "public" / fmt::format("{}.cert.pem", kind), "ca.cert.pem");
  }
  Write(folder / "public" / "crl.pem", MakeRevocationList({}, authority));
  Write(folder / "enclaves" / "governance.xml", GovernanceXml());
  Write(folder / "enclaves" / "governance.p7s", Sign(GovernanceXml(), authority));
}

void Add(const fs::path& folder, const Host& host, int days) {
  const OwnerOnly owner_only;
  Authority authority(folder);
  WriteHost(folder, host, authority, days);
  WriteRevocationList(folder, authority);
}

void Rotate(const fs::path& folder, const std::vector<std::string>& hosts, int days) {
  const OwnerOnly owner_only;
  Authority authority(folder);
  std::vector<Host> chosen;
  for (const std::string& host : hosts) chosen.push_back(ReadHost(folder, host));
  if (hosts.empty()) chosen = Hosts(folder);
  for (const Host& host : chosen) WriteHost(folder, host, authority, days);
  WriteRevocationList(folder, authority);
}

void Revoke(const fs::path& folder, const std::string& host) {
  const OwnerOnly owner_only;
  Authority authority(folder);
  ReadHost(folder, host);
  RevokeAll(EnclavesOf(folder, host), authority);
  WriteRevocationList(folder, authority);
  fs::remove_all(EnclavesOf(folder, host));
  fs::remove(RecordOf(folder, host));
}

std::vector<Host> Hosts(const fs::path& folder) {
  std::vector<Host> hosts;
  const fs::path records = folder / "private" / "conav_hosts";
  if (!fs::exists(records)) return hosts;
  for (const auto& entry : fs::directory_iterator(records)) {
    hosts.push_back(ReadHost(folder, entry.path().stem().string()));
  }
  std::ranges::sort(hosts, {}, &Host::name);
  return hosts;
}

}  // namespace conav::keystore
