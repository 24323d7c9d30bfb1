#include "common/bus/participant.h"

#include <fmt/core.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cstdlib>
#include <filesystem>

#include "common/bus/backend.h"
#include "common/bus/in_memory_bus.h"
#include "common/bus/ros_graph.h"
#include "common/runtime/config.h"
#include "common/runtime/file.h"
#include "common/runtime/log.h"
#include "common/runtime/text.h"

namespace conav::bus {

namespace {

constexpr int kMaximumDomain = 232;  // RTPS 2.5, 9.6.2.3: ports end there

std::string Environment(const char* name) {
  const char* value = std::getenv(name);
  return value == nullptr ? std::string() : std::string(value);
}

/// -1 when the variable is not set.
int DomainFrom(const char* variable) {
  const std::string text = Environment(variable);
  if (text.empty()) return -1;
  int domain = -1;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), domain);
  const bool whole = error == std::errc() && end == text.data() + text.size();
  if (!whole || domain < 0 || domain > kMaximumDomain) {
    throw StartupError(std::string(variable) + " = " + text + " is not a DDS domain (0 to 232)");
  }
  return domain;
}

/// kNone for distributions that are not known.
RosDistribution DistributionWithLayoutOf(std::string_view name) {
  constexpr std::array<std::string_view, 3> kLongGids{"foxy", "galactic", "humble"};
  constexpr std::array<std::string_view, 4> kShortGids{"iron", "jazzy", "kilted", "rolling"};
  if (std::ranges::find(kLongGids, name) != kLongGids.end()) return RosDistribution::kHumble;
  if (std::ranges::find(kShortGids, name) != kShortGids.end()) return RosDistribution::kJazzy;
  return RosDistribution::kNone;
}

constexpr std::size_t kLongestSystem = 64;

/// A name that is one value of user data.
void CheckSystem(const std::string& name) {
  const auto allowed = [](unsigned char c) {
    return std::isalnum(c) != 0 || c == '_' || c == '-' || c == '.';
  };
  if (name.size() <= kLongestSystem && std::ranges::all_of(name, allowed)) return;
  throw StartupError(fmt::format(
      "system = {} is not a name of at most {} letters, digits and _ - .", name, kLongestSystem));
}

std::filesystem::path FolderOf(const std::string& keystore, const std::string& enclave) {
  return std::filesystem::path(keystore) / "enclaves" /
         std::filesystem::path(enclave).relative_path();
}

std::string EnclaveOf(const ParticipantOptions& options) {
  if (!options.enclave.empty()) return options.enclave;
  const std::string name = Environment("ROS_SECURITY_ENCLAVE_OVERRIDE");
  if (!name.empty()) return name;
  return fmt::format("/conav/{}/{}/{}", HostName(), options.role, Name(*options.vendor));
}

/// Fills the keystore. Configured security is always enforced.
void ResolveSecurity(ParticipantOptions& options) {
  const bool configured = !options.keystore.empty();
  if (!configured && Environment("ROS_SECURITY_ENABLE") == "true") {
    options.keystore = Environment("ROS_SECURITY_KEYSTORE");
    if (options.keystore.empty()) {
      throw StartupError(
          "ROS_SECURITY_ENABLE is true, but ROS_SECURITY_KEYSTORE names no folder of keys");
    }
  }
  if (options.keystore.empty()) return;
  const auto folder = FolderOf(options.keystore, EnclaveOf(options));
  const bool permissive = !configured && Environment("ROS_SECURITY_STRATEGY") == "Permissive";
  if (!permissive || std::filesystem::exists(folder)) return;
  LOG_WARNING("no enclave, everything is sent in clear: ROS_SECURITY_STRATEGY is Permissive",
              "folder", folder.string());
  options.keystore.clear();
}

}  // namespace

Participant::Participant(const std::string& node_name, const ParticipantOptions& options)
    : node_name_(node_name), notifier_(std::make_unique<Notifier>()) {
  const ParticipantOptions resolved = Resolve(options);
  vendor_ = Name(*resolved.vendor);
  backend_ = resolved.vendor == Vendor::kFastDds ? MakeFastBackend(node_name, resolved)
                                                 : MakeCycloneBackend(node_name, resolved);
  LOG_INFO("on the bus", "node", node_name, "dds", vendor_, "domain", resolved.domain_id,
           "interface", resolved.interface.empty() ? "default" : resolved.interface, "system",
           resolved.system, "security", resolved.keystore.empty() ? "off" : EnclaveOf(resolved));
}

Participant::Participant(const std::string& node_name, std::shared_ptr<InMemoryBus> bus)
    : node_name_(node_name),
      vendor_("in-memory"),
      notifier_(std::make_unique<Notifier>()),
      backend_(MakeInMemoryBackend(std::move(bus))) {}

Participant::~Participant() = default;

bool Participant::Wait(std::chrono::nanoseconds timeout) { return notifier_->Wait(timeout); }

void Participant::Wake() { notifier_->Notify(); }

std::vector<Event> Participant::TakeEvents() { return backend_->TakeEvents(); }

bool Participant::over_link() const { return backend_->over_link(); }

void ParticipantOptions::Visit(ConfigReader& reader) {
  reader.Choice("vendor", vendor, kVendors);
  reader.Field("domain_id", domain_id, -1, kMaximumDomain);
  reader.Field("interface", interface);
  reader.Field("peers", peers);
  reader.Choice("ros_distribution", ros_distribution, kRosDistributions);
  reader.Field("lease_s", lease_s, 0.2, 3600.0);
  reader.Field("system", system);
  reader.Field("keystore", keystore);
  reader.Field("enclave", enclave);
}

ParticipantOptions Resolve(ParticipantOptions options) {
  if (const std::string name = Environment("CONAV_DDS"); !options.vendor && !name.empty()) {
    options.vendor = ParseVendor(name);
    if (!options.vendor) {
      throw StartupError(fmt::format("CONAV_DDS = {} is not a DDS vendor ({})", name,
                                     Join(Names(kVendors), ", ")));
    }
  }
  if (!options.vendor) options.vendor = kDefaultVendor;
  if (options.domain_id < 0) options.domain_id = DomainFrom("CONAV_DOMAIN");
  if (options.domain_id < 0) options.domain_id = std::max(0, DomainFrom("ROS_DOMAIN_ID"));
  if (options.domain_id > kMaximumDomain) {
    throw StartupError("domain_id = " + std::to_string(options.domain_id) +
                       " is not a DDS domain (0 to 232)");
  }
  if (options.interface.empty()) options.interface = Environment("CONAV_INTERFACE");
  if (!options.ros_distribution) {
    options.ros_distribution = DistributionWithLayoutOf(Environment("ROS_DISTRO"));
  }
  if (options.system.empty()) options.system = Environment("CONAV_SYSTEM");
  if (options.system.empty()) options.system = kDefaultSystem;
  CheckSystem(options.system);
  ResolveSecurity(options);
  return options;
}

std::optional<Enclave> FindEnclave(const ParticipantOptions& options) {
  if (options.keystore.empty()) return std::nullopt;
  const std::string name = EnclaveOf(options);
  const auto folder = std::filesystem::absolute(FolderOf(options.keystore, name));
  const auto find = [&](const char* file_name) {
    const auto file = folder / file_name;
    if (const auto readable = CheckReadable(file); !readable) {
      throw StartupError(fmt::format("DDS security is on, and enclave {} lacks a file: {}", name,
                                     readable.error().text));
    }
    return file.string();
  };
  Enclave enclave{.name = name,
                  .identity_ca = find("identity_ca.cert.pem"),
                  .certificate = find("cert.pem"),
                  .key = find("key.pem"),
                  .permissions_ca = find("permissions_ca.cert.pem"),
                  .governance = find("governance.p7s"),
                  .permissions = find("permissions.p7s"),
                  .crl = {}};
  if (std::filesystem::exists(folder / "crl.pem")) enclave.crl = find("crl.pem");
  return enclave;
}

}  // namespace conav::bus
