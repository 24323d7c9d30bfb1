#include "bench/perception/served_network.h"

#include <fstream>

#include "nhpm/config.h"

namespace conav::bench {
namespace {

namespace fs = std::filesystem;

bus::ParticipantOptions BusOn(const std::string& vendor, int domain) {
  bus::ParticipantOptions bus;
  bus.vendor = vendor;
  bus.domain_id = domain;
  bus.interface = "lo";
  return bus;
}

launcher::Process StartService(const std::string& vendor, int domain, const fs::path& weights,
                               const fs::path& folder) {
  nhpm::NhpmConfig config;
  config.bus = BusOn(vendor, domain);
  config.model = "nhpm";
  config.weights = weights.string();
  const fs::path file = folder / (vendor + ".yaml");
  std::ofstream(file) << DumpConfig("nhpm", config);
  const fs::path program = fs::read_symlink("/proc/self/exe").parent_path() / "conav-nhpm";
  return {"conav-nhpm", {program.string(), "--config", file.string()}, folder / (vendor + ".log")};
}

}  // namespace

TemporaryFolder::TemporaryFolder() {
  std::string pattern = (fs::temp_directory_path() / "conav-bench-XXXXXX").string();
  if (mkdtemp(pattern.data()) == nullptr) throw StartupError(pattern + ": cannot be made");
  path_ = pattern;
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  fs::remove_all(path_, ignored);
}

ServedNetwork::ServedNetwork(const std::string& vendor, int domain, const fs::path& weights,
                             const fs::path& folder)
    : vendor_(vendor),
      process_(StartService(vendor, domain, weights, folder)),
      participant_("planner", BusOn(vendor, domain)),
      model_(participant_, {.model = "nhpm", .timeout = std::chrono::seconds(60)}) {}

}  // namespace conav::bench
