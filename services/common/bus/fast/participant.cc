#include "common/bus/fast/participant.h"

#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>
#include <fastrtps/utils/IPLocator.h>
#include <fastrtps/xmlparser/XMLProfileManager.h>
#include <fmt/format.h>

#include <algorithm>
#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/log/Log.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/DataWriterListener.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/DataReaderListener.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>

#include "common/bus/backend.h"
#include "common/bus/events.h"
#include "common/bus/fast/sample.h"
#include "common/bus/intake.h"
#include "common/bus/ros_graph.h"
#include "common/runtime/log.h"
#include "common/runtime/result.h"

namespace conav::bus {
namespace {

namespace dds = eprosima::fastdds::dds;
namespace rtps = eprosima::fastrtps::rtps;
using eprosima::fastrtps::Duration_t;
using eprosima::fastrtps::types::ReturnCode_t;

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

/// Fast DDS sometimes rejects a sample for a full keep-all history long before max_blocking_time.
constexpr int kWriteAttempts = 3;

std::string Describe(const ReturnCode_t& code) {
  if (code == ReturnCode_t::RETCODE_TIMEOUT) return "queue full";
  if (code == ReturnCode_t::RETCODE_OUT_OF_RESOURCES) return "out of resources";
  return fmt::format("return code {}", code());
}

/// A Fast DDS participant with one publisher, one subscriber, and the topics in use.
/// Threads: safe to call concurrently.
class FastParticipant {
 public:
  /// Throws StartupError.
  FastParticipant(int domain_id, const dds::DomainParticipantQos& qos) {
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
  ~FastParticipant() { Close(); }
  FastParticipant(const FastParticipant&) = delete;
  FastParticipant& operator=(const FastParticipant&) = delete;

  /// Returns the one topic object per name that Fast DDS allows, and counts its users. `type` lives
  /// as long as the program. Throws StartupError.
  dds::Topic* AcquireTopic(const std::string& dds_name, const TypeSupport& type) {
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
  void ReleaseTopic(dds::Topic* topic) {
    const std::lock_guard lock(mutex_);
    if (--users_[topic] > 0) return;
    users_.erase(topic);
    participant_->delete_topic(topic);
  }

  dds::Publisher& publisher() { return *publisher_; }
  dds::Subscriber& subscriber() { return *subscriber_; }
  Guid guid() const { return ToGuid(participant_->guid()); }

 private:
  void Close() {
    participant_->delete_contained_entities();
    dds::DomainParticipantFactory::get_instance()->delete_participant(participant_);
  }

  dds::DomainParticipant* participant_;
  dds::Publisher* publisher_;
  dds::Subscriber* subscriber_;
  std::mutex mutex_;  // guards users_
  std::map<dds::Topic*, int> users_;
};

/// The state that the endpoints of one participant share. Outlives them.
struct FastContext {
  FastParticipant& participant;
  double lease_s;
  EventLog& events;
  RosGraph* graph;  // null for endpoints that ROS tools do not see
};

class FastWriter final : public Writer, private dds::DataWriterListener {
 public:
  FastWriter(const FastContext& context, const EndpointOptions& options)
      : context_(context),
        options_(options),
        events_(context.events, options.topic),
        topic_(context.participant.AcquireTopic(DdsTopicName(options.topic), options.type)),
        writer_(context.participant.publisher().create_datawriter(
            topic_, FastWriterQos(options.qos, context.lease_s), this,
            dds::StatusMask::publication_matched()
                << dds::StatusMask::offered_incompatible_qos())) {
    if (writer_ == nullptr) {
      context_.participant.ReleaseTopic(topic_);
      throw StartupError("Fast DDS cannot create a writer for " + options.topic);
    }
    if (context_.graph != nullptr) context_.graph->AddWriter(ToGuid(writer_->guid()));
  }
  ~FastWriter() override {
    if (context_.graph != nullptr) context_.graph->RemoveWriter(ToGuid(writer_->guid()));
    writer_->set_listener(nullptr);
    context_.participant.publisher().delete_datawriter(writer_);
    context_.participant.ReleaseTopic(topic_);
  }

  Result<void> Write(const void* message) override {
    FastSample sample{const_cast<void*>(message), true};
    if (options_.type.request_id != nullptr) return WriteWithId(sample);
    ReturnCode_t code = ReturnCode_t::RETCODE_TIMEOUT;
    for (int i = 0; i < kWriteAttempts && code == ReturnCode_t::RETCODE_TIMEOUT; ++i) {
      code = writer_->write(&sample, rtps::c_InstanceHandle_Unknown);
    }
    if (code == ReturnCode_t::RETCODE_OK) return {};
    if (code == ReturnCode_t::RETCODE_ERROR) {
      return Fail(ErrorCode::kMalformed,
                  "a message for " + options_.topic + " cannot be serialised");
    }
    return Fail(ErrorCode::kUnavailable,
                fmt::format("{} did not take a message: {}", options_.topic, Describe(code)));
  }
  bool WaitForAcknowledgments(std::chrono::nanoseconds timeout) override {
    const std::chrono::duration<long double> seconds = timeout;
    return writer_->wait_for_acknowledgments(Duration_t(seconds.count())) ==
           ReturnCode_t::RETCODE_OK;
  }
  int matched() const override {
    dds::PublicationMatchedStatus status;
    writer_->get_publication_matched_status(status);
    return status.current_count;
  }

 private:
  Result<void> WriteWithId(FastSample& sample) {
    RequestId& id = options_.type.request_id(sample.message);
    rtps::WriteParams parameters;
    parameters.related_sample_identity(ToIdentity(id));
    bool written = false;
    for (int i = 0; i < kWriteAttempts && !written; ++i) {
      written = writer_->write(&sample, parameters);
    }
    if (!written) return Fail(ErrorCode::kUnavailable, options_.topic + " did not take a message");
    if (!IsReplyTopic(options_.topic)) id.number = ToRequestId(parameters.sample_identity()).number;
    return {};
  }

  void on_publication_matched(dds::DataWriter*,
                              const dds::PublicationMatchedStatus& status) override {
    events_.Matched(status.current_count_change);
  }
  void on_offered_incompatible_qos(dds::DataWriter*,
                                   const dds::OfferedIncompatibleQosStatus& status) override {
    events_.IncompatibleQos(status.last_policy_id);
  }

  FastContext context_;
  EndpointOptions options_;
  EndpointEvents events_;
  dds::Topic* topic_;
  dds::DataWriter* writer_;
};

class FastReader final : public Reader, private dds::DataReaderListener {
 public:
  FastReader(const FastContext& context, const EndpointOptions& options, Sink sink)
      : context_(context),
        events_(context.events, options.topic),
        intake_(options, std::move(sink), context.events),
        check_repeats_(options.qos.durability == Durability::kTransientLocal),
        topic_(context.participant.AcquireTopic(DdsTopicName(options.topic), options.type)),
        reader_(context.participant.subscriber().create_datareader(
            topic_, FastReaderQos(options.qos), this,
            dds::StatusMask::data_available()
                << dds::StatusMask::subscription_matched() << dds::StatusMask::liveliness_changed()
                << dds::StatusMask::requested_incompatible_qos())) {
    if (reader_ == nullptr) {
      context_.participant.ReleaseTopic(topic_);
      throw StartupError("Fast DDS cannot create a reader for " + options.topic);
    }
    if (context_.graph != nullptr) context_.graph->AddReader(ToGuid(reader_->guid()));
  }
  ~FastReader() override {
    if (context_.graph != nullptr) context_.graph->RemoveReader(ToGuid(reader_->guid()));
    reader_->set_listener(nullptr);
    context_.participant.subscriber().delete_datareader(reader_);
    context_.participant.ReleaseTopic(topic_);
  }

  int matched() const override {
    dds::SubscriptionMatchedStatus status;
    reader_->get_subscription_matched_status(status);
    return status.current_count;
  }
  std::uint64_t malformed() const override { return intake_.malformed(); }
  Guid client_id() const override { return ToGuid(reader_->guid()); }

 private:
  void on_data_available(dds::DataReader* reader) override try {
    while (TakeOne(*reader)) {
    }
  } catch (const std::exception& error) {
    LOG_ERROR("messages lost", "topic", events_.topic(), "reason", error.what());
  }
  void on_subscription_matched(dds::DataReader*,
                               const dds::SubscriptionMatchedStatus& status) override {
    events_.Matched(status.current_count_change);
  }
  void on_liveliness_changed(dds::DataReader*,
                             const dds::LivelinessChangedStatus& status) override {
    events_.Liveliness(status.alive_count_change, status.not_alive_count_change);
  }
  void on_requested_incompatible_qos(dds::DataReader*,
                                     const dds::RequestedIncompatibleQosStatus& status) override {
    events_.IncompatibleQos(status.last_policy_id);
  }

  bool TakeOne(dds::DataReader& reader) {
    FastSample sample{intake_.Acquire(), false};
    dds::SampleInfo info;
    if (reader.take_next_sample(&sample, &info) != ReturnCode_t::RETCODE_OK) {
      intake_.Discard(sample.message);
      return false;
    }
    if (!info.valid_data || (check_repeats_ && IsRepeated(info))) {
      intake_.Discard(sample.message);
    } else if (sample.valid) {
      const EndpointOptions& options = intake_.endpoint();
      if (options.type.request_id != nullptr) {
        options.type.request_id(sample.message) = IdOf(info, IsReplyTopic(options.topic));
      }
      intake_.Accept(sample.message, ToSourceTime(info.source_timestamp.to_ns()));
    } else {
      intake_.Refuse(sample.message);
    }
    return true;
  }
  bool IsRepeated(const dds::SampleInfo& info) {
    const auto& identity = info.sample_identity;
    const auto number = static_cast<std::int64_t>(identity.sequence_number().to64long());
    return !deduplicator_.IsNew(ToGuid(identity.writer_guid()), number);
  }

  FastContext context_;
  EndpointEvents events_;
  Intake intake_;
  const bool check_repeats_;  // vendors only repeat transient-local history
  Deduplicator deduplicator_;
  dds::Topic* topic_;
  dds::DataReader* reader_;
};

class FastBackend final : public Backend {
 public:
  FastBackend(const std::string& node_name, const ParticipantOptions& options)
      : participant_(options.domain_id,
                     FastParticipantQos(node_name, ResolveNetwork(options), options.lease_s)),
        lease_s_(options.lease_s),
        graph_(node_name, options.ros_distribution.value(), participant_.guid()) {
    if (!graph_.publishes()) return;
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
  builtin.discovery_config.leaseDuration = Duration_t(lease_s);
  builtin.discovery_config.leaseDuration_announcementperiod =
      Duration_t(std::min(lease_s / 3.0, network.multicast ? 3.0 : 1.0));
  if (network.multicast) return qos;
  builtin.metatrafficUnicastLocatorList.push_back(UdpLocator(network.interface_address));
  for (const std::string& peer : network.peers) {
    builtin.initialPeersList.push_back(UdpLocator(peer));
  }
  return qos;
}

dds::DataWriterQos FastWriterQos(const Qos& qos, double lease_s) {
  dds::DataWriterQos result;
  Fill(qos, result);
  result.reliability().max_blocking_time = Duration_t(0.1);
  result.liveliness().kind = dds::AUTOMATIC_LIVELINESS_QOS;
  result.liveliness().lease_duration = Duration_t(lease_s);
  result.liveliness().announcement_period = Duration_t(lease_s / 3.0);
  // Bounds how long the loss of the last sample of a burst goes unnoticed; the default is 3 s.
  result.reliable_writer_qos().times.heartbeatPeriod = Duration_t(0.1);
  return result;
}

dds::DataReaderQos FastReaderQos(const Qos& qos) {
  dds::DataReaderQos result;
  Fill(qos, result);
  return result;
}

std::unique_ptr<Backend> MakeFastBackend(const std::string& node_name,
                                         const ParticipantOptions& options) {
  return std::make_unique<FastBackend>(node_name, options);
}

}  // namespace conav::bus
