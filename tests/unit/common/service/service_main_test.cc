#include "common/service/service_main.h"

#include <malloc.h>

#include <catch2/catch.hpp>
#include <cstdlib>
#include <memory>
#include <vector>

#include "common/runtime/file.h"
#include "support/resident_memory.h"
#include "support/scoped_variable.h"
#include "support/temporary_folder.h"
#include "support/wait.h"

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
  const FreedMemory freed_memory;
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

TEST_CASE("Free pages between small blocks go back to the system", "[common][service]") {
  if (!test::kMeasuresMemory) return;
  constexpr std::size_t kBlocks = 8192;
  constexpr std::size_t kBytes = 16 * 1024;
  std::vector<std::unique_ptr<char[]>> large;
  std::vector<std::unique_ptr<int>> small;
  for (std::size_t i = 0; i < kBlocks; ++i) {  // 128 MiB
    large.push_back(std::make_unique<char[]>(kBytes));
    small.push_back(std::make_unique<int>(1));
  }
  const double before = test::ResidentMiB();
  large.clear();
  CHECK(test::ResidentMiB() > before - 10.0);
  const FreedMemory freed_memory(std::chrono::milliseconds(10));
  CHECK(test::WaitUntil([&] { return test::ResidentMiB() < before - 60.0; }));
}

// Two hours of soak: the simulator's memory swung by 30 MB, as Mesa took and freed it for each picture.
TEST_CASE("A service that draws keeps the memory that it freed", "[common][service]") {
  if (!test::kMeasuresMemory) return;
  KeepFreedMemory();
  auto large = std::make_unique<char[]>(std::size_t{16} << 20);
  const double before = test::ResidentMiB();
  large.reset();
  CHECK(test::ResidentMiB() > before - 4.0);
}

}  // namespace
}  // namespace conav
