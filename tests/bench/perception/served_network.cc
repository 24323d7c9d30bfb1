#include "bench/perception/served_network.h"

#include "common/runtime/file.h"
#include "nhpm/config.h"
#include "support/test_domain.h"

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
  if (const auto written = WriteFile(file, DumpConfig("nhpm", config)); !written) {
    throw StartupError(written.error().text);
  }
  const fs::path program = fs::read_symlink("/proc/self/exe").parent_path() / "conav-nhpm";
  return {"conav-nhpm", {program.string(), "--config", file.string()}, folder / (vendor + ".log")};
}

}  // namespace

ServedNetwork::ServedNetwork(const std::string& vendor, const fs::path& weights,
                             const fs::path& folder)
    : vendor_(vendor),
      domain_(test::LeaseDomain()),
      process_(StartService(vendor, domain_.domain(), weights, folder)),
      participant_("planner", BusOn(vendor, domain_.domain())),
      model_(participant_, {.model = "nhpm", .timeout = std::chrono::seconds(60)}) {}

}  // namespace conav::bench
