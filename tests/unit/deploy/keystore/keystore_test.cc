#include "keystore/keystore.h"

#include <sys/stat.h>

#include <algorithm>
#include <catch2/catch.hpp>

#include "common/runtime/file.h"
#include "common/runtime/result.h"
#include "support/temporary_folder.h"

namespace conav::keystore {
namespace {

namespace fs = std::filesystem;

std::string Text(const fs::path& file) {
  const auto text = ReadFile(file);
  REQUIRE(text);
  return *text;
}

struct Bench : test::TemporaryFolder {
  Bench() { Init(folder, 30); }

  fs::path Enclave(const std::string& name) const { return folder / "enclaves" / "conav" / name; }
  std::string Certificate(const std::string& name) const {
    return Text(Enclave(name) / "cert.pem");
  }
  std::vector<std::string> Revoked(const std::string& enclave) const {
    return RevokedIn(Text(Enclave(enclave) / "crl.pem"));
  }

  fs::path folder = path() / "keys";
};

TEST_CASE("an enclave has the files of SROS2, and only their owner reads them", "[keystore]") {
  const Bench bench;
  Add(bench.folder, {"h1", {"sim"}, {}}, 10);
  for (const char* vendor : {"cyclonedds", "fastdds"}) {
    for (const char* file :
         {"cert.pem", "key.pem", "identity_ca.cert.pem", "permissions_ca.cert.pem",
          "governance.p7s", "permissions.xml", "permissions.p7s", "crl.pem"}) {
      CAPTURE(vendor, file);
      CHECK(fs::is_regular_file(bench.Enclave("h1/sim") / vendor / file));
    }
  }
  for (const auto& entry : fs::recursive_directory_iterator(bench.folder)) {
    struct stat status {};
    REQUIRE(stat(entry.path().c_str(), &status) == 0);
    CAPTURE(entry.path().string());
    CHECK((status.st_mode & 0777) == (entry.is_directory() ? 0700u : 0600u));
  }
  CHECK(Text(bench.folder / "public" / "identity_ca.cert.pem") ==
        Text(bench.Enclave("h1/sim/fastdds") / "identity_ca.cert.pem"));
}

TEST_CASE("Cyclone DDS begins the handshakes with Fast DDS: its subjects have the lower hash",
          "[keystore]") {
  const Bench bench;
  Add(bench.folder, {"h1", {kRoles.begin(), kRoles.end()}, {}}, 10);
  for (const std::string_view role : kRoles) {
    CAPTURE(role);
    const std::string enclave = "h1/" + std::string(role);
    CHECK(SubjectHash(bench.Certificate(enclave + "/cyclonedds")) < 0x80);
    CHECK(SubjectHash(bench.Certificate(enclave + "/fastdds")) >= 0x80);
  }
}

TEST_CASE("rotating makes new keys and revokes the old, revoking takes a host out", "[keystore]") {
  const Bench bench;
  Add(bench.folder, {"h1", {"sim"}, {{"r1"}, {}}}, 10);
  Add(bench.folder, {"h2", {"planner"}, {}}, 10);
  const std::string sim = SerialOf(bench.Certificate("h1/sim/fastdds"));
  const std::string planner = SerialOf(bench.Certificate("h2/planner/fastdds"));
  const std::string key = Text(bench.Enclave("h1/sim/fastdds") / "key.pem");
  CHECK(bench.Revoked("h2/planner/cyclonedds").empty());

  Rotate(bench.folder, {"h1"}, 10);
  CHECK(Text(bench.Enclave("h1/sim/fastdds") / "key.pem") != key);
  CHECK(Text(bench.Enclave("h1/sim/fastdds") / "permissions.xml").find("rt/r1/state") !=
        std::string::npos);
  const auto revoked = bench.Revoked("h2/planner/cyclonedds");
  CHECK(revoked.size() == 2);
  CHECK(std::ranges::find(revoked, sim) != revoked.end());

  Revoke(bench.folder, "h2");
  CHECK_FALSE(fs::exists(bench.Enclave("h2")));
  const auto now_revoked = bench.Revoked("h1/sim/cyclonedds");
  CHECK(now_revoked.size() == 4);
  CHECK(std::ranges::find(now_revoked, planner) != now_revoked.end());
  REQUIRE(Hosts(bench.folder).size() == 1);
  CHECK(Hosts(bench.folder)[0].grant.robots == std::vector<std::string>{"r1"});
}

TEST_CASE("a keystore is not made twice, and unknown hosts are named", "[keystore]") {
  const Bench bench;
  CHECK_THROWS_AS(Init(bench.folder, 30), StartupError);
  CHECK_THROWS_WITH(Revoke(bench.folder, "h9"), Catch::Contains("h9"));
  CHECK_THROWS_WITH(Rotate(bench.folder, {"h9"}, 10), Catch::Contains("h9"));
  CHECK_THROWS_AS(Add(bench.path() / "elsewhere", {"h1", {"sim"}, {}}, 10), StartupError);
  CHECK(HostFolder("robot-1.lan") == "robot_1_lan");
}

TEST_CASE("a certificate is of the authority that signed it, of no other", "[keystore]") {
  const Identity authority = MakeAuthority("conav", 30);
  const Identity other = MakeAuthority("conav", 30);
  const std::string certificate =
      MakeIdentity("/conav/h1/sim/fastdds", "0", authority, 10).certificate;
  CHECK(IsSignedBy(certificate, authority.certificate));
  CHECK_FALSE(IsSignedBy(certificate, other.certificate));
}

}  // namespace
}  // namespace conav::keystore
