#include "common/service/service_main.h"

#include <catch2/catch.hpp>

#include "common/runtime/file.h"
#include "support/scoped_variable.h"
#include "support/temporary_folder.h"

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
    REQUIRE(WriteFile(path(), "pump:\n  ros__parameters: " + parameters + "\n"));
  }
  std::string path() const { return (folder_ / "pump.yaml").string(); }

 private:
  test::TemporaryFolder folder_;
};

TEST_CASE("a value that is refused is named with its file", "[service]") {
  const ConfigFile file("{pressure: 12}");
  CHECK_THROWS_WITH(LoadConfig<PumpConfig>(file.path(), "pump"),
                    Catch::StartsWith(file.path() + ": pump.pressure = 12"));
}

TEST_CASE("the effective config has what the file says and the environment fills", "[service]") {
  const ConfigFile file("{pressure: 2, bus: {lease_s: 1.5}}");
  const test::ScopedVariable domain("CONAV_DOMAIN", "17");
  const PumpConfig config = LoadConfig<PumpConfig>(file.path(), "pump");
  CHECK(config.pressure == 2);
  CHECK(config.bus.domain_id == 17);
  CHECK(config.bus.lease_s == 1.5);
}

}  // namespace
}  // namespace conav
