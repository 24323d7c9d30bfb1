#include "common/bus/cyclone/domain.h"

#include <fmt/format.h>

#include <map>
#include <mutex>

#include "common/runtime/log.h"
#include "common/runtime/result.h"

namespace conav::bus {
namespace {

/// While an interface is down, Cyclone logs a failing send for each packet. This passes on at most
/// one line a second, and not to /rosout, since sending to it may be what fails.
void LogLine(void*, const dds_log_data_t* data) {
  static LogLimit limit;  // there is one sink per process
  const bool is_error = (data->priority & (DDS_LC_FATAL | DDS_LC_ERROR)) != 0;
  if (!is_error && (data->priority & DDS_LC_WARNING) == 0) return;
  const auto held_back = limit.Allow();
  if (!held_back) return;
  std::string_view text(data->message, data->size);
  while (!text.empty() && (text.back() == '\n' || text.back() == '\0')) text.remove_suffix(1);
  log::Event(log::Reach::kStderr, is_error ? log::Level::kError : log::Level::kWarning,
             "Cyclone DDS", "text", text, "held_back", *held_back);
}

std::string Peers(const Network& network) {
  if (network.multicast) return {};
  std::string peers;
  for (const std::string& peer : network.peers) {
    peers += fmt::format("<Peer Address=\"{}\"/>", peer);
  }
  return fmt::format("<SPDPInterval>1s</SPDPInterval><Peers>{}</Peers>", peers);
}

/// Loopback carries datagrams of 64 kB whole. On a real link Cyclone's smaller default keeps the
/// loss of one IP fragment from costing 64 kB.
std::string Datagrams(const Network& network) {
  if (!network.loopback) return {};
  return "<MaxMessageSize>65500B</MaxMessageSize><FragmentSize>64000B</FragmentSize>";
}

/// Multicast is for discovery only. Two readers that ask for data by multicast crash a Fast DDS
/// 2.9.1 writer of Debian 12: "OutputTrafficManager ... Assertion `it != collection_.end()'
/// failed".
std::string Multicast(const Network& network) {
  return fmt::format("<AllowMulticast>{}</AllowMulticast>", network.multicast ? "spdp" : "false");
}

std::string Interfaces(const Network& network) {
  if (network.interface_name.empty()) return {};
  return fmt::format("<Interfaces><NetworkInterface address=\"{}\"/></Interfaces>",
                     network.interface_address);
}

}  // namespace

std::string CycloneConfiguration(const Network& network, double lease_s) {
  return fmt::format(
      "<Domain id=\"any\">"
      "<General>{}{}{}</General>"
      "<Discovery><ParticipantIndex>auto</ParticipantIndex>"
      "<MaxAutoParticipantIndex>{}</MaxAutoParticipantIndex>{}"
      "<LeaseDuration>{} ms</LeaseDuration></Discovery>"
      "<Internal><GenerateKeyhash>true</GenerateKeyhash>"
      "<SocketReceiveBufferSize min=\"default\" max=\"4MB\"/></Internal>"
      "</Domain>",
      Interfaces(network), Multicast(network), Datagrams(network), kHighestParticipantIndex,
      Peers(network), static_cast<int>(lease_s * 1000.0));
}

std::shared_ptr<CycloneDomain> CycloneDomain::Open(int domain_id,
                                                   const std::string& configuration) {
  // Mirrors Cyclone's process-wide table of domains, which has no query function.
  static std::mutex mutex;
  static std::map<int, std::weak_ptr<CycloneDomain>> open_domains;
  const std::lock_guard lock(mutex);
  if (auto domain = open_domains[domain_id].lock()) {
    if (domain->configuration_ == configuration) return domain;
    throw StartupError(fmt::format(
        "DDS domain {} is already open in this process with another interface, peers or lease",
        domain_id));
  }
  auto domain = std::make_shared<CycloneDomain>(domain_id, configuration);
  open_domains[domain_id] = domain;
  return domain;
}

CycloneDomain::CycloneDomain(int domain_id, std::string configuration)
    : configuration_(std::move(configuration)) {
  dds_set_log_sink(LogLine, nullptr);
  domain_ = dds_create_domain(static_cast<dds_domainid_t>(domain_id), configuration_.c_str());
  if (domain_ < 0) {
    throw StartupError(fmt::format(
        "Cyclone DDS cannot open domain {}: {} (no free participant index among {}, "
        "or the interface cannot be used; configuration {})",
        domain_id, dds_strretcode(-domain_), kHighestParticipantIndex + 1, configuration_));
  }
}

CycloneDomain::~CycloneDomain() { dds_delete(domain_); }

}  // namespace conav::bus
