#include "common/bus/fast/participant.h"

#include <fastrtps/xmlparser/XMLProfileManager.h>
#include <fmt/core.h>

#include <algorithm>
#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/domain/DomainParticipantListener.hpp>
#include <fastdds/dds/log/Log.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/DataWriterListener.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/DataReaderListener.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <map>
#include <optional>
#include <set>

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

/// Fast DDS sometimes rejects a sample for a full keep-all history long before max_blocking_time.
constexpr int kWriteAttempts = 3;

std::string Describe(const ReturnCode_t& code) {
  if (code == ReturnCode_t::RETCODE_TIMEOUT) return "queue full";
  if (code == ReturnCode_t::RETCODE_OUT_OF_RESOURCES) return "out of resources";
  return fmt::format("return code {}", code());
}

/// What remote endpoints say in their user data: which readers are Demand::kSparse, which writers are of
/// another system. Fast DDS 2.9 tells the QoS of an endpoint only here, just before its match. Threads:
/// safe to call concurrently.
class PeerEndpoints final : public dds::DomainParticipantListener {
 public:
  explicit PeerEndpoints(std::string system) : system_(std::move(system)) {}

  bool IsSparse(const rtps::GUID_t& reader) {
    const std::lock_guard lock(mutex_);
    return sparse_readers_.contains(reader);
  }
  /// The system of a writer, if it is another one than ours.
  std::optional<std::string> OtherSystemOf(const rtps::GUID_t& writer) {
    const std::lock_guard lock(mutex_);
    const auto found = other_writers_.find(writer);
    if (found == other_writers_.end()) return std::nullopt;
    return found->second;
  }

 private:
  template <class Info>
  static std::string Value(std::string_view key, const Info& info) {
    const auto& octets = info.m_qos.m_userData.data_vec();
    return std::string(ValueOf(key, std::string(octets.begin(), octets.end())));
  }
  void on_subscriber_discovery(dds::DomainParticipant*,
                               rtps::ReaderDiscoveryInfo&& found) override {
    const std::lock_guard lock(mutex_);
    if (found.status == rtps::ReaderDiscoveryInfo::REMOVED_READER) {
      sparse_readers_.erase(found.info.guid());
    } else if (!Value(kSparseKey, found.info).empty()) {
      sparse_readers_.insert(found.info.guid());
    }
  }
  /// One that is gone stays known for a while: what it sent may still be on its way to a reader.
  void on_publisher_discovery(dds::DomainParticipant*, rtps::WriterDiscoveryInfo&& found) override {
    if (found.status == rtps::WriterDiscoveryInfo::REMOVED_WRITER) return;
    std::string system = Value(kSystemKey, found.info);
    const std::lock_guard lock(mutex_);
    if (system.empty() || system == system_) return;
    if (other_writers_.size() >= kMostOthers) other_writers_.clear();
    other_writers_[found.info.guid()] = std::move(system);
  }

  static constexpr std::size_t kMostOthers = 10'000;

  const std::string system_;
  std::mutex mutex_;  // guards what follows
  std::set<rtps::GUID_t> sparse_readers_;
  std::map<rtps::GUID_t, std::string> other_writers_;
};

/// A Fast DDS participant with one publisher, one subscriber, and the topics in use.
/// Threads: safe to call concurrently.
class FastParticipant {
 public:
  /// Throws StartupError.
  FastParticipant(int domain_id, const std::string& system, const dds::DomainParticipantQos& qos)
      : peers_(system) {
    static std::once_flag configured;
    std::call_once(configured, ConfigureLibrary);
    participant_ = dds::DomainParticipantFactory::get_instance()->create_participant(
        static_cast<dds::DomainId_t>(domain_id), qos, &peers_, dds::StatusMask::none());
    if (participant_ == nullptr) {
      throw StartupError(fmt::format(
          "Fast DDS cannot open domain {} (interface or ports in use, or the files of its "
          "enclave are refused)",
          domain_id));
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
  PeerEndpoints& peers() { return peers_; }
  Guid guid() const { return ToGuid(participant_->guid()); }

 private:
  void Close() {
    participant_->delete_contained_entities();
    dds::DomainParticipantFactory::get_instance()->delete_participant(participant_);
  }

  PeerEndpoints peers_;
  dds::DomainParticipant* participant_;
  dds::Publisher* publisher_;
  dds::Subscriber* subscriber_;
  std::mutex mutex_;  // guards users_
  std::map<dds::Topic*, int> users_;
};

/// The state that the endpoints of one participant share. Outlives them.
struct FastContext {
  FastParticipant& participant;
  std::string system;
  bool loopback;
  double lease_s;
  EventLog& events;
  RosGraph* graph;  // null for endpoints that ROS tools do not see
};

/// `qos` with the user data of the endpoint.
template <class FastQos>
FastQos WithSystem(FastQos qos, const FastContext& context, const EndpointOptions& options) {
  const std::string data = EndpointUserData(context.system, options.qos, context.loopback);
  qos.user_data().data_vec({data.begin(), data.end()});
  return qos;
}

class FastWriter final : public Writer, private dds::DataWriterListener {
 public:
  FastWriter(const FastContext& context, const EndpointOptions& options)
      : context_(context),
        options_(options),
        events_(context.events, options.topic),
        topic_(context.participant.AcquireTopic(DdsTopicName(options.topic), options.type)),
        writer_(context.participant.publisher().create_datawriter(
            topic_,
            WithSystem(FastWriterQos(options.qos, context.loopback, context.lease_s), context,
                       options),
            this,
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
  int demanding() const override {
    const int readers = matched();
    const std::lock_guard lock(mutex_);
    return std::max(0, readers - static_cast<int>(sparse_.size()));
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
    const rtps::GUID_t reader = rtps::iHandle2GUID(status.last_subscription_handle);
    {
      const std::lock_guard lock(mutex_);
      if (status.current_count_change < 0) {
        sparse_.erase(reader);
      } else if (context_.participant.peers().IsSparse(reader)) {
        sparse_.insert(reader);
      }
    }
    events_.Matched(status.current_count_change);
  }
  void on_offered_incompatible_qos(dds::DataWriter*,
                                   const dds::OfferedIncompatibleQosStatus& status) override {
    events_.IncompatibleQos(status.last_policy_id);
  }

  FastContext context_;
  EndpointOptions options_;
  EndpointEvents events_;
  mutable std::mutex mutex_;       // guards sparse_
  std::set<rtps::GUID_t> sparse_;  // of the matched readers
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
        deduplicator_(options.qos.depth),
        topic_(context.participant.AcquireTopic(DdsTopicName(options.topic), options.type)),
        reader_(context.participant.subscriber().create_datareader(
            topic_, WithSystem(FastReaderQos(options.qos), context, options), this,
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
    if (status.current_count_change <= 0) return;
    const auto writer = rtps::iHandle2GUID(status.last_publication_handle);
    if (const auto system = context_.participant.peers().OtherSystemOf(writer)) {
      events_.OtherSystem(*system);
    }
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
    const rtps::GUID_t& writer = info.sample_identity.writer_guid();
    if (!info.valid_data || context_.participant.peers().OtherSystemOf(writer) ||
        (check_repeats_ && IsRepeated(info))) {
      intake_.Discard(sample.message);
    } else if (sample.valid) {
      const EndpointOptions& options = intake_.endpoint();
      if (options.type.request_id != nullptr) {
        options.type.request_id(sample.message) = IdOf(info, IsReplyTopic(options.topic));
      }
      intake_.Accept(sample.message, {ToSourceTime(info.source_timestamp.to_ns()), ToGuid(writer)});
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
      : network_(ResolveNetwork(options)),
        participant_(options.domain_id, options.system, FastParticipantQos(node_name, options)),
        relay_(network_, options.domain_id),
        system_(options.system),
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
  bool over_link() const override { return !network_.loopback; }

 private:
  FastContext Context(RosGraph* graph) {
    return {participant_, system_, network_.loopback, lease_s_, events_, graph};
  }

  const Network network_;
  FastParticipant participant_;
  AnnouncementRelay relay_;
  const std::string system_;
  double lease_s_;
  EventLog events_;
  RosGraph graph_;
};

}  // namespace

std::unique_ptr<Backend> MakeFastBackend(const std::string& node_name,
                                         const ParticipantOptions& options) {
  return std::make_unique<FastBackend>(node_name, options);
}

}  // namespace conav::bus
