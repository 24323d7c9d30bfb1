#include "common/bus/participant.h"

#include <algorithm>
#include <charconv>
#include <cstdlib>

#include "common/bus/backend.h"
#include "common/bus/in_memory_bus.h"
#include "common/runtime/log.h"

namespace conav::bus {

Participant::Participant(const std::string& node_name, const ParticipantOptions& options)
    : node_name_(node_name), notifier_(std::make_unique<Notifier>()) {
  const ParticipantOptions resolved = Resolve(options);
  vendor_ = Name(*resolved.vendor);
  backend_ = resolved.vendor == Vendor::kFastDds ? MakeFastBackend(node_name, resolved)
                                                 : MakeCycloneBackend(node_name, resolved);
  LOG_INFO("on the bus", "node", node_name, "dds", vendor_, "domain", resolved.domain_id,
           "interface", resolved.interface.empty() ? "default" : resolved.interface);
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

}  // namespace

void ParticipantOptions::Visit(ConfigReader& reader) {
  reader.Choice("vendor", vendor, kVendors);
  reader.Field("domain_id", domain_id, -1, kMaximumDomain);
  reader.Field("interface", interface);
  reader.Field("peers", peers);
  reader.Choice("ros_distribution", ros_distribution, kRosDistributions);
  reader.Field("lease_s", lease_s, 0.2, 3600.0);
}

ParticipantOptions Resolve(ParticipantOptions options) {
  if (const std::string name = Environment("CONAV_DDS"); !options.vendor && !name.empty()) {
    options.vendor = ParseVendor(name);
    if (!options.vendor) {
      throw StartupError(fmt::format("CONAV_DDS = {} is not a DDS vendor ({})", name,
                                     fmt::join(Names(kVendors), ", ")));
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
  return options;
}

}  // namespace conav::bus
