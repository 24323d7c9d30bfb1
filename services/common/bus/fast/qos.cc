#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>
#include <fastrtps/utils/IPLocator.h>

#include <algorithm>
#include <memory>

#include "common/bus/backend.h"
#include "common/bus/fast/participant.h"

namespace conav::bus {
namespace {

namespace dds = eprosima::fastdds::dds;
namespace rtps = eprosima::fastrtps::rtps;
using eprosima::fastrtps::Duration_t;

constexpr std::uint32_t kSocketBuffer = 4 * 1024 * 1024;
/// Of a datagram on a real link: it fits one IP packet. Fast DDS's own 64 kB become 45 of them, and
/// the loss of one costs the whole datagram: at 10 % loss no picture arrives (bench loss).
constexpr std::uint32_t kLinkDatagram = 1400;
/// The same with security: Fast DDS sends a participant's certificate and permissions, some kB, in one datagram.
constexpr std::uint32_t kSecureLinkDatagram = 16384;

/// Port 0: computed by RTPS from domain and participant index.
rtps::Locator_t UdpLocator(const std::string& address, int port) {
  rtps::Locator_t locator;
  locator.kind = LOCATOR_KIND_UDPv4;
  locator.port = static_cast<std::uint32_t>(port);
  if (!address.empty()) rtps::IPLocator::setIPv4(locator, address);
  return locator;
}

std::vector<rtps::octet> Octets(const std::string& text) { return {text.begin(), text.end()}; }

/// The QoS that readers and writers share.
template <class FastQos>
void Fill(const Qos& qos, FastQos& result) {
  const bool reliable = qos.reliability == Reliability::kReliable;
  result.reliability().kind =
      reliable ? dds::RELIABLE_RELIABILITY_QOS : dds::BEST_EFFORT_RELIABILITY_QOS;
  const bool transient = qos.durability == Durability::kTransientLocal;
  result.durability().kind =
      transient ? dds::TRANSIENT_LOCAL_DURABILITY_QOS : dds::VOLATILE_DURABILITY_QOS;
  if (qos.depth > 0) {
    result.history().kind = dds::KEEP_LAST_HISTORY_QOS;
    result.history().depth = qos.depth;
  } else {
    // Without limits, Fast DDS slows down and its history grows forever when the peer cannot keep
    // up.
    result.history().kind = dds::KEEP_ALL_HISTORY_QOS;
    result.resource_limits().max_samples = kKeepAllLimit;
    result.resource_limits().max_samples_per_instance = kKeepAllLimit;
    result.resource_limits().max_instances = 1;
  }
  result.data_sharing().off();
  // The other policies reject an empty payload, such as a dispose, and stall the writer.
  result.endpoint().history_memory_policy = rtps::PREALLOCATED_WITH_REALLOC_MEMORY_MODE;
}

/// The plugins of DDS security and their files.
void SetSecurity(const Enclave& enclave, dds::DomainParticipantQos& qos) {
  auto& properties = qos.properties().properties();
  const auto set = [&properties](const std::string& name, const std::string& value) {
    properties.emplace_back("dds.sec." + name, value);
  };
  const std::string file = "file://";
  const std::string authentication = "auth.builtin.PKI-DH.";
  const std::string access = "access.builtin.Access-Permissions.";
  set("auth.plugin", "builtin.PKI-DH");
  set("access.plugin", "builtin.Access-Permissions");
  set("crypto.plugin", "builtin.AES-GCM-GMAC");
  set(authentication + "identity_ca", file + enclave.identity_ca);
  set(authentication + "identity_certificate", file + enclave.certificate);
  set(authentication + "private_key", file + enclave.key);
  if (!enclave.crl.empty()) set(authentication + "identity_crl", file + enclave.crl);
  set(access + "permissions_ca", file + enclave.permissions_ca);
  set(access + "governance", file + enclave.governance);
  set(access + "permissions", file + enclave.permissions);
}

}  // namespace

dds::DomainParticipantQos FastParticipantQos(const std::string& node_name, const Network& network,
                                             double lease_s) {
  dds::DomainParticipantQos qos;
  qos.name(node_name);
  auto udp = std::make_shared<eprosima::fastdds::rtps::UDPv4TransportDescriptor>();
  udp->receiveBufferSize = kSocketBuffer;
  udp->sendBufferSize = kSocketBuffer;
  if (!network.loopback) udp->maxMessageSize = kLinkDatagram;
  if (!network.interface_name.empty()) {
    udp->interfaceWhiteList.push_back(network.interface_address);
  }
  qos.transport().use_builtin_transports = false;
  qos.transport().user_transports.push_back(udp);

  auto& builtin = qos.wire_protocol().builtin;
  builtin.discovery_config.leaseDuration = Duration_t(lease_s);
  builtin.discovery_config.leaseDuration_announcementperiod =
      Duration_t(std::min(lease_s / 3.0, network.multicast ? 3.0 : network.announcement_s()));
  if (network.multicast) return qos;
  builtin.metatrafficUnicastLocatorList.push_back(UdpLocator(network.interface_address, 0));
  for (const auto* some : {&network.own_ports, &network.remote_relays}) {
    for (const Peer& peer : *some) {
      builtin.initialPeersList.push_back(UdpLocator(peer.address, peer.port));
    }
  }
  return qos;
}

dds::DataWriterQos FastWriterQos(const Qos& qos, bool loopback, double lease_s) {
  dds::DataWriterQos result;
  Fill(qos, result);
  result.reliability().max_blocking_time = Duration_t(0.1);
  result.liveliness().kind = dds::AUTOMATIC_LIVELINESS_QOS;
  result.liveliness().lease_duration = Duration_t(lease_s);
  result.liveliness().announcement_period = Duration_t(lease_s / 3.0);
  // Bounds how long the loss of a sample goes unnoticed, since Fast DDS's readers look for gaps only
  // then; the default is 3 s. At 10 % loss each way and 0.1 s the p95 of commands is 190 ms, with
  // this 100 ms (bench loss). Only unacknowledged samples cost heartbeats.
  result.reliable_writer_qos().times.heartbeatPeriod = Duration_t(loopback ? 0.1 : 0.03);
  return result;
}

dds::DataReaderQos FastReaderQos(const Qos& qos) {
  dds::DataReaderQos result;
  Fill(qos, result);
  return result;
}

dds::DomainParticipantQos FastParticipantQos(const std::string& node_name,
                                             const ParticipantOptions& options) {
  auto qos = FastParticipantQos(node_name, ResolveNetwork(options), options.lease_s);
  const auto enclave = FindEnclave(options);
  qos.user_data().data_vec(Octets(ParticipantUserData(enclave ? enclave->name : "/")));
  if (!enclave) return qos;
  SetSecurity(*enclave, qos);
  for (const auto& transport : qos.transport().user_transports) {
    transport->maxMessageSize = std::max(transport->maxMessageSize, kSecureLinkDatagram);
  }
  return qos;
}

}  // namespace conav::bus
