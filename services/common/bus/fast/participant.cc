#include "common/bus/fast/participant.h"

#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>
#include <fastrtps/utils/IPLocator.h>
#include <fastrtps/xmlparser/XMLProfileManager.h>
#include <fmt/format.h>

#include <algorithm>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/log/Log.hpp>

#include "common/bus/backend.h"
#include "common/bus/fast/entities.h"
#include "common/bus/fast/erased_type.h"
#include "common/runtime/log.h"
#include "common/runtime/result.h"

namespace conav::bus {
namespace {

namespace dds = eprosima::fastdds::dds;
namespace rtps = eprosima::fastrtps::rtps;

constexpr std::uint32_t kSocketBuffer = 4 * 1024 * 1024;
constexpr std::string_view kRosUserData = "enclave=/;";

/// Redirects Fast DDS's log from stdout, which belongs to the program. Fast DDS repeats some errors
/// for each packet: this passes on at most one a second, and not to /rosout, since sending to it
/// may be what fails.
class LogToOurs final : public dds::LogConsumer {
 public:
  void Consume(const dds::Log::Entry& entry) override {
    const bool is_error = entry.kind == dds::Log::Kind::Error;
    if (!is_error && entry.kind != dds::Log::Kind::Warning) return;
    const auto held_back = (is_error ? errors_ : warnings_).Allow();
    if (!held_back) return;
    log::Event(log::Reach::kStderr, is_error ? log::Level::kError : log::Level::kDebug, "Fast DDS",
               "text", entry.message, "held_back", *held_back);
  }

 private:
  LogLimit errors_;
  LogLimit warnings_;
};

/// Settings of the whole process. Participants of one process talk over the network like any
/// others: handed over directly, a message can reach a reader of a participant that was just
/// destroyed (Fast DDS pull request 5034; fixed after the versions of Debian 12).
void ConfigureLibrary() {
  dds::Log::ClearConsumers();
  dds::Log::RegisterConsumer(std::make_unique<LogToOurs>());
  eprosima::fastrtps::LibrarySettingsAttributes settings;
  settings.intraprocess_delivery = eprosima::fastrtps::INTRAPROCESS_OFF;
  eprosima::fastrtps::xmlparser::XMLProfileManager::library_settings(settings);
}

rtps::Locator_t UdpLocator(const std::string& address) {
  rtps::Locator_t locator;
  locator.kind = LOCATOR_KIND_UDPv4;
  locator.port = 0;  // computed by RTPS from domain and participant index
  if (!address.empty()) rtps::IPLocator::setIPv4(locator, address);
  return locator;
}

class FastBackend final : public Backend {
 public:
  FastBackend(const std::string& node_name, const ParticipantOptions& options)
      : participant_(options.domain_id,
                     FastParticipantQos(node_name, ResolveNetwork(options), options.lease_s)),
        lease_s_(options.lease_s),
        graph_(node_name, options.ros_distribution, participant_.guid()) {
    graph_.Start(std::make_unique<FastWriter>(Context(nullptr), graph_.endpoint()));
  }

  std::unique_ptr<Writer> CreateWriter(const EndpointOptions& options) override {
    return std::make_unique<FastWriter>(Context(&graph_), options);
  }
  std::unique_ptr<Reader> CreateReader(const EndpointOptions& options, Sink sink) override {
    return std::make_unique<FastReader>(Context(&graph_), options, std::move(sink));
  }
  std::vector<Event> TakeEvents() override { return events_.Take(); }

 private:
  FastContext Context(RosGraph* graph) { return {participant_, lease_s_, events_, graph}; }

  FastParticipant participant_;
  double lease_s_;
  EventLog events_;
  RosGraph graph_;
};

}  // namespace

dds::DomainParticipantQos FastParticipantQos(const std::string& node_name, const Network& network,
                                             double lease_s) {
  dds::DomainParticipantQos qos;
  qos.name(node_name);
  qos.user_data().data_vec({kRosUserData.begin(), kRosUserData.end()});
  auto udp = std::make_shared<eprosima::fastdds::rtps::UDPv4TransportDescriptor>();
  udp->receiveBufferSize = kSocketBuffer;
  udp->sendBufferSize = kSocketBuffer;
  udp->maxInitialPeersRange = kHighestParticipantIndex + 1;
  if (!network.interface_name.empty()) {
    udp->interfaceWhiteList.push_back(network.interface_address);
  }
  qos.transport().use_builtin_transports = false;
  qos.transport().user_transports.push_back(udp);

  auto& builtin = qos.wire_protocol().builtin;
  builtin.discovery_config.leaseDuration = eprosima::fastrtps::Duration_t(lease_s);
  builtin.discovery_config.leaseDuration_announcementperiod =
      eprosima::fastrtps::Duration_t(std::min(lease_s / 3.0, network.multicast ? 3.0 : 1.0));
  if (network.multicast) return qos;
  builtin.metatrafficUnicastLocatorList.push_back(UdpLocator(network.interface_address));
  for (const std::string& peer : network.peers) {
    builtin.initialPeersList.push_back(UdpLocator(peer));
  }
  return qos;
}

Guid ToGuid(const rtps::GUID_t& guid) {
  Guid bytes;
  const auto entity = std::copy_n(guid.guidPrefix.value, 12, bytes.begin());
  std::copy_n(guid.entityId.value, 4, entity);
  return bytes;
}

FastParticipant::FastParticipant(int domain_id, const dds::DomainParticipantQos& qos) {
  static std::once_flag configured;
  std::call_once(configured, ConfigureLibrary);
  participant_ = dds::DomainParticipantFactory::get_instance()->create_participant(
      static_cast<dds::DomainId_t>(domain_id), qos);
  if (participant_ == nullptr) {
    throw StartupError(
        fmt::format("Fast DDS cannot open domain {} (interface or ports in use)", domain_id));
  }
  publisher_ = participant_->create_publisher(dds::PUBLISHER_QOS_DEFAULT);
  subscriber_ = participant_->create_subscriber(dds::SUBSCRIBER_QOS_DEFAULT);
  if (publisher_ == nullptr || subscriber_ == nullptr) {
    Close();
    throw StartupError("Fast DDS cannot create a publisher and a subscriber");
  }
}

FastParticipant::~FastParticipant() { Close(); }

void FastParticipant::Close() {
  participant_->delete_contained_entities();
  dds::DomainParticipantFactory::get_instance()->delete_participant(participant_);
}

dds::Topic* FastParticipant::AcquireTopic(const std::string& dds_name, const TypeSupport& type) {
  const std::lock_guard lock(mutex_);
  for (auto& [topic, users] : users_) {
    if (topic->get_name() != dds_name) continue;
    if (topic->get_type_name() != type.name) {
      throw StartupError(fmt::format("topic {} has type {} in this process, not {}", dds_name,
                                     topic->get_type_name(), type.name));
    }
    ++users;
    return topic;
  }
  const dds::TypeSupport known = participant_->find_type(type.name);
  if (known.empty()) {
    participant_->register_type(dds::TypeSupport(new ErasedType(type)));
  } else if (&static_cast<ErasedType&>(*known).type() != &type) {
    throw StartupError(fmt::format("two types of this process are called {}", type.name));
  }
  dds::Topic* topic = participant_->create_topic(dds_name, type.name, dds::TOPIC_QOS_DEFAULT);
  if (topic == nullptr) throw StartupError("Fast DDS cannot create topic " + dds_name);
  users_[topic] = 1;
  return topic;
}

void FastParticipant::ReleaseTopic(dds::Topic* topic) {
  const std::lock_guard lock(mutex_);
  if (--users_[topic] > 0) return;
  users_.erase(topic);
  participant_->delete_topic(topic);
}

std::unique_ptr<Backend> MakeFastBackend(const std::string& node_name,
                                         const ParticipantOptions& options) {
  return std::make_unique<FastBackend>(node_name, options);
}

}  // namespace conav::bus
