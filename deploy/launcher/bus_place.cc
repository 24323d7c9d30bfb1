#include "launcher/bus_place.h"

#include <fmt/format.h>

#include <chrono>
#include <cstdlib>
#include <optional>
#include <utility>

#include "common/bus/vendors.h"

namespace conav::launcher {
namespace {

using std::chrono::steady_clock;

// Discovery on one machine takes a few milliseconds, over a network a few hundred.
constexpr std::chrono::milliseconds kListenTime{600};
constexpr int kDomainsTried = 40;

std::optional<int> WantedDomain(const DemoOptions& options) {
  if (options.domain) return options.domain;
  const char* text = std::getenv("CONAV_DOMAIN");
  if (text == nullptr) return std::nullopt;
  char* end = nullptr;
  const long domain = std::strtol(text, &end, 10);
  if (*text == '\0' || *end != '\0' || domain < 0 || domain > 232) {
    throw UsageError(fmt::format("CONAV_DOMAIN={}: not a DDS domain (0 to 232)", text));
  }
  return static_cast<int>(domain);
}

std::string ListenForRobots(BusPlace& place) {
  const auto deadline = steady_clock::now() + kListenTime;
  while (steady_clock::now() < deadline) {
    const std::string robot = place.recorder->published_robot();
    if (!robot.empty()) return robot;
    place.participant->Wait(std::chrono::milliseconds(20));
  }
  return "";
}

// Why the domain cannot be had; empty when `place` has it.
std::string TryDomain(const DemoOptions& options, int domain, Episode& episode,
                      std::optional<BusPlace>& place) {
  auto lease = DomainLease::TryAcquire(domain);
  if (!lease) return fmt::format("DDS domain {} is taken by another conav demo here", domain);
  place.emplace(JoinKeptDomain(options, *std::move(lease), episode));
  const std::string robot = ListenForRobots(*place);
  if (robot.empty()) return "";
  place.reset();
  return fmt::format("DDS domain {} is taken: another conav publishes robot {} there", domain,
                     robot);
}

}  // namespace

bus::ParticipantOptions BusOptions(const DemoOptions& options, int domain,
                                   const std::string& vendor) {
  bus::ParticipantOptions bus;
  bus.vendor = vendor;
  bus.domain_id = domain;
  bus.interface = options.interface;
  bus.peers = options.peers;
  return bus::Resolve(std::move(bus));
}

BusPlace JoinKeptDomain(const DemoOptions& options, DomainLease lease, Episode& episode) {
  const std::string vendor = VendorOfService(options.dds)->at("launcher");
  auto participant = std::make_unique<bus::Participant>(
      "conav_launcher", BusOptions(options, lease.domain(), vendor));
  auto recorder = std::make_unique<Recorder>(*participant, episode);
  return {std::move(lease), std::move(participant), std::move(recorder)};
}

BusPlace JoinFreeDomain(const DemoOptions& options, Episode& episode) {
  const std::optional<int> wanted = WantedDomain(options);
  std::optional<BusPlace> place;
  std::string refusal;
  const int first = wanted.value_or(0);
  const int last = wanted ? first : kDomainsTried - 1;
  for (int domain = first; domain <= last; ++domain) {
    refusal = TryDomain(options, domain, episode, place);
    if (refusal.empty()) return *std::move(place);
  }
  throw UsageError(refusal + "; choose another with --domain");
}

}  // namespace conav::launcher
