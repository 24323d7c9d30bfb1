#include "common/bus/cyclone/backend.h"

#include <fmt/core.h>

#include <algorithm>
#include <cstring>
#include <functional>
#include <map>
#include <mutex>
#include <string_view>
#include <vector>

#include "common/bus/cyclone/serdata.h"
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
  for (const auto* some : {&network.own_ports, &network.remote_relays}) {
    for (const Peer& peer : *some) {
      peers += fmt::format("<Peer Address=\"{}:{}\"/>", peer.address, peer.port);
    }
  }
  return fmt::format("<SPDPInterval>{:.0f} ms</SPDPInterval><Peers>{}</Peers>",
                     1000.0 * network.announcement_s(), peers);
}

/// Loopback carries datagrams of 64 kB whole. On a real link each fits one IP packet, so that a lost
/// packet costs no others; Cyclone's own 14 kB become ten.
std::string Datagrams(const Network& network) {
  if (!network.loopback)
    return "<MaxMessageSize>1400B</MaxMessageSize><FragmentSize>1300B</FragmentSize>";
  return "<MaxMessageSize>65500B</MaxMessageSize><FragmentSize>64000B</FragmentSize>";
}

/// How soon a loss is noticed and repaired: Cyclone's own 100 ms for both double the p95 of commands
/// at 30 % loss, 490 ms instead of 240 (bench loss). Loopback loses nothing.
std::string Repairs(const Network& network) {
  if (network.loopback) return {};
  return "<NackDelay>10 ms</NackDelay><HeartbeatInterval>50 ms</HeartbeatInterval>";
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

// A writer is deleted at once. By default each waits up to a second for readers that may be dead, one
// after the other. And it holds up to 500 kB that some reader has not acknowledged: by default it
// begins with 30 kB and goes down to 1 kB after repairs, so that one peer that was killed holds up
// all others until its lease ends.
std::string CycloneConfiguration(const Network& network, double lease_s) {
  return fmt::format(
      "<Domain id=\"any\">"
      "<General>{}{}{}</General>"
      "<Discovery><ParticipantIndex>auto</ParticipantIndex>"
      "<MaxAutoParticipantIndex>{}</MaxAutoParticipantIndex>{}"
      "<LeaseDuration>{} ms</LeaseDuration></Discovery>"
      "<Internal><GenerateKeyhash>true</GenerateKeyhash>"
      "<WriterLingerDuration>0 s</WriterLingerDuration>"
      "<Watermarks><WhcAdaptive>false</WhcAdaptive><WhcHighInit>500 kB</WhcHighInit></Watermarks>"
      "<SocketReceiveBufferSize min=\"default\" max=\"4MB\"/>{}</Internal>"
      "</Domain>",
      Interfaces(network), Multicast(network), Datagrams(network), kHighestParticipantIndex,
      Peers(network), static_cast<int>(lease_s * 1000.0), Repairs(network));
}

namespace {

/// A Cyclone DDS domain. There is one per process and domain number, shared by its participants.
class CycloneDomain {
 public:
  /// Opens the domain or returns the open one. Throws StartupError when Cyclone rejects the
  /// configuration, or when the domain is open with a different one.
  static std::shared_ptr<CycloneDomain> Open(int domain_id, const std::string& configuration) {
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

  CycloneDomain(int domain_id, std::string configuration)
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
  ~CycloneDomain() { dds_delete(domain_); }
  CycloneDomain(const CycloneDomain&) = delete;
  CycloneDomain& operator=(const CycloneDomain&) = delete;

 private:
  std::string configuration_;
  dds_entity_t domain_;
};

/// Of a participant or endpoint; empty = it has none.
std::string UserDataOf(const dds_qos_t* qos) {
  void* data = nullptr;
  std::size_t size = 0;
  if (!dds_qget_userdata(qos, &data, &size)) return {};
  std::string text(static_cast<const char*>(data), size);
  dds_free(data);
  return text;
}

using ListenerPointer = std::unique_ptr<dds_listener_t, void (*)(dds_listener_t*)>;

class CycloneReader final : public Reader {
 public:
  CycloneReader(const CycloneContext& context, const EndpointOptions& options, Sink sink);
  ~CycloneReader() override {
    if (context_.graph != nullptr) context_.graph->RemoveReader(reader_.guid());
  }

  int matched() const override {
    dds_subscription_matched_status_t status{};
    dds_get_subscription_matched_status(reader_.handle(), &status);
    return static_cast<int>(status.current_count);
  }
  std::uint64_t malformed() const override { return intake_.malformed(); }
  /// Eight bytes, the only ones that a payload has room for.
  Guid client_id() const override {
    const Guid guid = reader_.guid();
    Guid id{};
    std::transform(guid.begin(), guid.begin() + 8, guid.begin() + 8, id.begin(), std::bit_xor());
    return id;
  }

  /// Called by Cyclone, one call at a time, already before the constructor has the handle.
  void TakeAll(dds_entity_t reader) noexcept {
    constexpr int kBatch = 16;
    ddsi_serdata* samples[kBatch];
    dds_sample_info_t infos[kBatch];
    int count = kBatch;
    while (count == kBatch) {
      count = dds_takecdr(reader, samples, kBatch, infos, DDS_ANY_STATE);
      for (int i = 0; i < count; ++i) {
        if (infos[i].valid_data) Deliver(reader, AsSerdata(samples[i]), infos[i]);
        ddsi_serdata_unref(samples[i]);
      }
    }
  }
  /// Also called by Cyclone, with the status of the newest match.
  void CountMatched(dds_entity_t reader, const dds_subscription_matched_status_t& status) noexcept {
    events_.Matched(status.current_count_change);
    if (status.current_count_change > 0) WriterOf(reader, status.last_publication_handle);
  }
  EndpointEvents& events() { return events_; }

 private:
  struct PeerWriter {
    Guid guid{};
    bool is_of_other_system = false;
  };

  void Deliver(dds_entity_t reader, const Serdata& sample, const dds_sample_info_t& info) noexcept {
    const PeerWriter writer = WriterOf(reader, info.publication_handle);
    if (writer.is_of_other_system) return;
    if (check_repeats_ && IsRepeated(writer.guid, info.source_timestamp)) return;
    intake_.Deliver(sample.payload(), {ToSourceTime(info.source_timestamp), writer.guid});
  }
  bool IsRepeated(const Guid& writer, dds_time_t stamp) try {
    return !deduplicator_.IsNew(writer, stamp);
  } catch (const std::exception&) {
    return false;  // out of memory: a duplicate is better than a loss
  }
  /// Cyclone gives a writer a new handle when it reappears; the GUID stays the same. Of a writer that is
  /// gone already nothing is known, unless its match was seen.
  PeerWriter WriterOf(dds_entity_t reader, dds_instance_handle_t publication) noexcept try {
    const std::lock_guard lock(mutex_);
    const auto known = writers_.find(publication);
    if (known != writers_.end()) return known->second;
    PeerWriter writer;
    std::memcpy(writer.guid.data(), &publication, sizeof publication);
    if (auto* endpoint = dds_get_matched_publication_data(reader, publication)) {
      std::memcpy(writer.guid.data(), &endpoint->key, writer.guid.size());
      const std::string system(ValueOf(kSystemKey, UserDataOf(endpoint->qos)));
      writer.is_of_other_system = !system.empty() && system != context_.system;
      if (writer.is_of_other_system) events_.OtherSystem(system);
      dds_builtintopic_free_endpoint(endpoint);
    }
    if (writers_.size() >= Deduplicator::kWriters) writers_.clear();
    return writers_[publication] = writer;
  } catch (const std::exception&) {
    return {};
  }

  CycloneContext context_;
  EndpointEvents events_;
  Intake intake_;
  const bool check_repeats_;  // vendors only repeat transient-local history
  Deduplicator deduplicator_;
  std::mutex mutex_;  // guards writers_
  std::map<dds_instance_handle_t, PeerWriter> writers_;
  CycloneEntity topic_;
  CycloneEntity reader_;  // last: its callbacks use the other members
};

EndpointEvents& WriterEvents(void* argument) { return *static_cast<EndpointEvents*>(argument); }
CycloneReader& ReaderOf(void* argument) { return *static_cast<CycloneReader*>(argument); }

void OnPublicationMatched(dds_entity_t, dds_publication_matched_status_t status, void* argument) {
  WriterEvents(argument).Matched(status.current_count_change);
}

void OnOfferedIncompatibleQos(dds_entity_t, dds_offered_incompatible_qos_status_t status,
                              void* argument) {
  WriterEvents(argument).IncompatibleQos(status.last_policy_id);
}

void OnData(dds_entity_t reader, void* argument) { ReaderOf(argument).TakeAll(reader); }

void OnSubscriptionMatched(dds_entity_t reader, dds_subscription_matched_status_t status,
                           void* argument) {
  ReaderOf(argument).CountMatched(reader, status);
}

void OnLiveliness(dds_entity_t, dds_liveliness_changed_status_t status, void* argument) {
  ReaderOf(argument).events().Liveliness(status.alive_count_change, status.not_alive_count_change);
}

void OnRequestedIncompatibleQos(dds_entity_t, dds_requested_incompatible_qos_status_t status,
                                void* argument) {
  ReaderOf(argument).events().IncompatibleQos(status.last_policy_id);
}

/// Reports matches and incompatible QoS of a writer. `events` outlives the writer's entity.
ListenerPointer WriterListener(EndpointEvents& events) {
  ListenerPointer listener(dds_create_listener(&events), dds_delete_listener);
  dds_lset_publication_matched(listener.get(), OnPublicationMatched);
  dds_lset_offered_incompatible_qos(listener.get(), OnOfferedIncompatibleQos);
  return listener;
}

/// Delivers data and reports matches, liveliness and incompatible QoS. `reader` outlives its
/// entity.
ListenerPointer ReaderListener(CycloneReader& reader) {
  ListenerPointer listener(dds_create_listener(&reader), dds_delete_listener);
  dds_lset_data_available(listener.get(), OnData);
  dds_lset_subscription_matched(listener.get(), OnSubscriptionMatched);
  dds_lset_liveliness_changed(listener.get(), OnLiveliness);
  dds_lset_requested_incompatible_qos(listener.get(), OnRequestedIncompatibleQos);
  return listener;
}

using QosPointer = std::unique_ptr<dds_qos_t, void (*)(dds_qos_t*)>;

constexpr dds_duration_t kMaximumBlocking = DDS_MSECS(100);
constexpr int kWriteAttempts = 3;

QosPointer MakeQos(const Qos& qos, const CycloneContext& context) {
  QosPointer result(dds_create_qos(), dds_delete_qos);
  const std::string user_data = EndpointUserData(context.system, qos, context.loopback);
  dds_qset_userdata(result.get(), user_data.data(), user_data.size());
  const bool reliable = qos.reliability == Reliability::kReliable;
  dds_qset_reliability(result.get(),
                       reliable ? DDS_RELIABILITY_RELIABLE : DDS_RELIABILITY_BEST_EFFORT,
                       kMaximumBlocking);
  const auto history = qos.depth > 0 ? DDS_HISTORY_KEEP_LAST : DDS_HISTORY_KEEP_ALL;
  dds_qset_history(result.get(), history, qos.depth);
  if (qos.durability == Durability::kTransientLocal) {
    dds_qset_durability(result.get(), DDS_DURABILITY_TRANSIENT_LOCAL);
    // This depth, not that of the history policy, limits what a late joiner gets.
    const int limit = qos.depth > 0 ? DDS_LENGTH_UNLIMITED : kKeepAllLimit;
    dds_qset_durability_service(result.get(), 0, history, qos.depth, limit, limit, limit);
  }
  return result;
}

QosPointer MakeWriterQos(const Qos& qos, const CycloneContext& context) {
  QosPointer result = MakeQos(qos, context);
  dds_qset_liveliness(result.get(), DDS_LIVELINESS_AUTOMATIC,
                      static_cast<dds_duration_t>(context.lease_s * 1e9));
  dds_qset_writer_data_lifecycle(result.get(), false);
  return result;
}

dds_entity_t CreateTopic(dds_entity_t participant, const EndpointOptions& options) {
  ddsi_sertype* sertype = MakeSertype(options.type);
  const std::string name = DdsTopicName(options.topic);
  const dds_entity_t topic =
      dds_create_topic_sertype(participant, name.c_str(), &sertype, nullptr, nullptr, nullptr);
  if (topic < 0) ddsi_sertype_unref(sertype);
  return topic;
}

}  // namespace

CycloneEntity::CycloneEntity(dds_entity_t handle, const std::string& what) : handle_(handle) {
  if (handle < 0) {
    throw StartupError(
        fmt::format("Cyclone DDS cannot create {}: {}", what, dds_strretcode(-handle)));
  }
}

Guid CycloneEntity::guid() const {
  dds_guid_t cyclone_guid{};
  dds_get_guid(handle_, &cyclone_guid);
  Guid guid;
  static_assert(sizeof cyclone_guid == sizeof guid);
  std::memcpy(guid.data(), &cyclone_guid, guid.size());
  return guid;
}

CycloneWriter::CycloneWriter(const CycloneContext& context, const EndpointOptions& options)
    : context_(context),
      options_(options),
      events_(context.events, options.topic),
      topic_(CreateTopic(context.participant, options), "topic " + options.topic),
      writer_(dds_create_writer(context.participant, topic_.handle(),
                                MakeWriterQos(options.qos, context).get(),
                                WriterListener(events_).get()),
              "a writer for " + options.topic) {
  if (context_.graph != nullptr) context_.graph->AddWriter(writer_.guid());
}

CycloneWriter::~CycloneWriter() {
  if (context_.graph != nullptr) context_.graph->RemoveWriter(writer_.guid());
}

Result<void> CycloneWriter::Write(const void* message) {
  dds_return_t code = DDS_RETCODE_TIMEOUT;
  for (int i = 0; i < kWriteAttempts && code == DDS_RETCODE_TIMEOUT; ++i) {
    code = dds_write(writer_.handle(), message);
  }
  if (code == DDS_RETCODE_OK) return {};
  if (code == DDS_RETCODE_BAD_PARAMETER) {
    return Fail(ErrorCode::kMalformed, "a message for " + options_.topic + " cannot be serialised");
  }
  return Fail(ErrorCode::kUnavailable,
              fmt::format("{} did not take a message: {}", options_.topic, dds_strretcode(-code)));
}

bool CycloneWriter::WaitForAcknowledgments(std::chrono::nanoseconds timeout) {
  return dds_wait_for_acks(writer_.handle(), timeout.count()) == DDS_RETCODE_OK;
}

int CycloneWriter::matched() const {
  dds_publication_matched_status_t status{};
  dds_get_publication_matched_status(writer_.handle(), &status);
  return static_cast<int>(status.current_count);
}

int CycloneWriter::demanding() const {
  std::vector<dds_instance_handle_t> readers(static_cast<std::size_t>(matched()));
  const dds_return_t count =
      dds_get_matched_subscriptions(writer_.handle(), readers.data(), readers.size());
  int sparse = 0;
  for (std::size_t i = 0; i < readers.size() && static_cast<dds_return_t>(i) < count; ++i) {
    auto* endpoint = dds_get_matched_subscription_data(writer_.handle(), readers[i]);
    if (endpoint == nullptr) continue;
    sparse += ValueOf(kSparseKey, UserDataOf(endpoint->qos)).empty() ? 0 : 1;
    dds_builtintopic_free_endpoint(endpoint);
  }
  return std::max(0, static_cast<int>(count) - sparse);
}

namespace {

CycloneReader::CycloneReader(const CycloneContext& context, const EndpointOptions& options,
                             Sink sink)
    : context_(context),
      events_(context.events, options.topic),
      intake_(options, std::move(sink), context.events),
      check_repeats_(options.qos.durability == Durability::kTransientLocal),
      deduplicator_(options.qos.depth),
      topic_(CreateTopic(context.participant, options), "topic " + options.topic),
      reader_(dds_create_reader(context.participant, topic_.handle(),
                                MakeQos(options.qos, context).get(), ReaderListener(*this).get()),
              "a reader for " + options.topic) {
  if (context_.graph != nullptr) context_.graph->AddReader(reader_.guid());
}

/// The properties that load Cyclone's plugins and their files.
void SetSecurity(dds_qos_t* qos, const Enclave& enclave) {
  const auto set = [qos](const std::string& name, const std::string& value) {
    dds_qset_prop(qos, name.c_str(), value.c_str());
  };
  const auto set_plugin = [&set](const std::string& prefix, const std::string& library,
                                 const std::string& function) {
    set(prefix + ".library.path",
        fmt::format("{}/libdds_security_{}.so", CONAV_CYCLONE_PLUGINS, library));
    set(prefix + ".library.init", "init_" + function);
    set(prefix + ".library.finalize", "finalize_" + function);
  };
  set_plugin("dds.sec.auth", "auth", "authentication");
  set_plugin("dds.sec.access", "ac", "access_control");
  set_plugin("dds.sec.crypto", "crypto", "crypto");
  const std::string file = "file:";
  set("dds.sec.auth.identity_ca", file + enclave.identity_ca);
  set("dds.sec.auth.identity_certificate", file + enclave.certificate);
  set("dds.sec.auth.private_key", file + enclave.key);
  set("dds.sec.access.permissions_ca", file + enclave.permissions_ca);
  set("dds.sec.access.governance", file + enclave.governance);
  set("dds.sec.access.permissions", file + enclave.permissions);
  if (!enclave.crl.empty()) set("org.eclipse.cyclonedds.sec.auth.crl", file + enclave.crl);
}

/// ROS 2 recognises its participants by their user data.
dds_entity_t CreateParticipant(const ParticipantOptions& options) {
  const auto enclave = FindEnclave(options);
  const QosPointer qos(dds_create_qos(), dds_delete_qos);
  const std::string user_data = ParticipantUserData(enclave ? enclave->name : "/");
  dds_qset_userdata(qos.get(), user_data.data(), user_data.size());
  if (enclave) SetSecurity(qos.get(), *enclave);
  return dds_create_participant(static_cast<dds_domainid_t>(options.domain_id), qos.get(), nullptr);
}

class CycloneBackend final : public Backend {
 public:
  CycloneBackend(const std::string& node_name, const ParticipantOptions& options)
      : network_(ResolveNetwork(options)),
        domain_(CycloneDomain::Open(options.domain_id,
                                    CycloneConfiguration(network_, options.lease_s))),
        participant_(CreateParticipant(options), "a participant"),
        relay_(network_, options.domain_id),
        system_(options.system),
        lease_s_(options.lease_s),
        graph_(node_name, options.ros_distribution.value(), participant_.guid()) {
    if (!graph_.publishes()) return;
    graph_.Start(std::make_unique<CycloneWriter>(Context(nullptr), graph_.endpoint()));
  }

  std::unique_ptr<Writer> CreateWriter(const EndpointOptions& options) override {
    return std::make_unique<CycloneWriter>(Context(&graph_), options);
  }
  std::unique_ptr<Reader> CreateReader(const EndpointOptions& options, Sink sink) override {
    return std::make_unique<CycloneReader>(Context(&graph_), options, std::move(sink));
  }
  std::vector<Event> TakeEvents() override { return events_.Take(); }
  bool over_link() const override { return !network_.loopback; }

 private:
  CycloneContext Context(RosGraph* graph) {
    return {participant_.handle(), system_, network_.loopback, lease_s_, events_, graph};
  }

  const Network network_;
  std::shared_ptr<CycloneDomain> domain_;
  CycloneEntity participant_;
  AnnouncementRelay relay_;
  const std::string system_;
  double lease_s_;
  EventLog events_;
  RosGraph graph_;
};

}  // namespace

std::unique_ptr<Backend> MakeCycloneBackend(const std::string& node_name,
                                            const ParticipantOptions& options) {
  return std::make_unique<CycloneBackend>(node_name, options);
}

}  // namespace conav::bus
