#include "common/service/service_main.h"

#include <malloc.h>

#include <catch2/catch.hpp>
#include <cstdlib>
#include <memory>

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

// Faults of memory, G8: a planner's arenas grew by 14 MB/h while it used no more of them.
TEST_CASE("Large blocks go back to the system, also after larger ones", "[common][service]") {
  ReturnFreedMemory();
  constexpr std::size_t kLarge = std::size_t{1} << 20;
  const auto mapped_for = [](std::size_t size) {  // in blocks of their own
    const std::size_t before = mallinfo2().hblkhd;
    const std::unique_ptr<void, void (*)(void*)> block(std::malloc(size), std::free);
    REQUIRE(block);
    return mallinfo2().hblkhd - before;
  };
  if (mapped_for(40 * kLarge) == 0) return;  // the allocator of a sanitizer
  CHECK(mapped_for(16 * kLarge) > 0);
  CHECK(mapped_for(2 * kLarge) >= 2 * kLarge);
  CHECK(mapped_for(kLarge / 128) == 0);
}

}  // namespace
}  // namespace conav
