#include "common/service/service_main.h"

#include <catch2/catch.hpp>
#include <cstdlib>
#include <fstream>

namespace conav {
namespace {

struct PumpConfig {
  int pressure = 5;
  bus::ParticipantOptions bus;
  void Visit(ConfigReader& reader) {
    reader.Field("pressure", pressure, 1, 9);
    reader.Section("bus", bus);
  }
};

class ConfigFile {
 public:
  explicit ConfigFile(const std::string& parameters) {
    std::string pattern = (std::filesystem::temp_directory_path() / "conav-pump-XXXXXX").string();
    close(mkstemp(pattern.data()));
    path_ = pattern;
    std::ofstream(path_) << "pump:\n  ros__parameters: " << parameters << "\n";
  }
  ~ConfigFile() { std::filesystem::remove(path_); }
  std::string path() const { return path_; }

 private:
  std::filesystem::path path_;
};

TEST_CASE("a value that is refused is named with its file", "[service]") {
  const ConfigFile file("{pressure: 12}");
  CHECK_THROWS_WITH(LoadConfig<PumpConfig>(file.path(), "pump"),
                    file.path() + ": pump.pressure = 12 is out of range [1, 9]");
  const ConfigFile nested("{bus: {domain: 3}}");
  CHECK_THROWS_WITH(LoadConfig<PumpConfig>(nested.path(), "pump"),
                    Catch::StartsWith(nested.path() + ": pump.bus: unknown key 'domain'"));
}

TEST_CASE("the effective config tells the vendor, domain and interface that count", "[service]") {
  const ConfigFile file("{pressure: 2, bus: {lease_s: 1.5}}");
  setenv("CONAV_DDS", "fastdds", 1);
  setenv("CONAV_DOMAIN", "17", 1);
  setenv("CONAV_INTERFACE", "lo", 1);
  const PumpConfig config = LoadConfig<PumpConfig>(file.path(), "pump");
  for (const char* name : {"CONAV_DDS", "CONAV_DOMAIN", "CONAV_INTERFACE"}) unsetenv(name);
  CHECK(config.pressure == 2);
  CHECK(config.bus.vendor == "fastdds");
  CHECK(config.bus.domain_id == 17);
  CHECK(config.bus.interface == "lo");
  CHECK(config.bus.lease_s == 1.5);
}

}  // namespace
}  // namespace conav
