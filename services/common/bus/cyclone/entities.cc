#include "common/bus/cyclone/entities.h"

#include <fmt/format.h>

#include <cstring>
#include <memory>

#include "common/bus/cyclone/serdata.h"
#include "common/bus/network.h"
#include "common/runtime/log.h"

namespace conav::bus {
namespace {


using ListenerPointer = std::unique_ptr<dds_listener_t, void (*)(dds_listener_t*)>;

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

void OnSubscriptionMatched(dds_entity_t, dds_subscription_matched_status_t status, void* argument) {
  ReaderOf(argument).events().Matched(status.current_count_change);
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

QosPointer MakeQos(const Qos& qos) {
  QosPointer result(dds_create_qos(), dds_delete_qos);
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

QosPointer MakeWriterQos(const Qos& qos, double lease_s) {
  QosPointer result = MakeQos(qos);
  dds_qset_liveliness(result.get(), DDS_LIVELINESS_AUTOMATIC,
                      static_cast<dds_duration_t>(lease_s * 1e9));
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
                                MakeWriterQos(options.qos, context.lease_s).get(),
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

CycloneReader::CycloneReader(const CycloneContext& context, const EndpointOptions& options,
                             Sink sink)
    : context_(context),
      events_(context.events, options.topic),
      intake_(options, std::move(sink), context.events),
      check_repeats_(options.qos.durability == Durability::kTransientLocal),
      topic_(CreateTopic(context.participant, options), "topic " + options.topic),
      reader_(dds_create_reader(context.participant, topic_.handle(), MakeQos(options.qos).get(),
                                ReaderListener(*this).get()),
              "a reader for " + options.topic) {
  if (context_.graph != nullptr) context_.graph->AddReader(reader_.guid());
}

CycloneReader::~CycloneReader() {
  if (context_.graph != nullptr) context_.graph->RemoveReader(reader_.guid());
}

int CycloneReader::matched() const {
  dds_subscription_matched_status_t status{};
  dds_get_subscription_matched_status(reader_.handle(), &status);
  return static_cast<int>(status.current_count);
}

void CycloneReader::TakeAll(dds_entity_t reader) noexcept {
  constexpr int kBatch = 16;
  ddsi_serdata* samples[kBatch];
  dds_sample_info_t infos[kBatch];
  int count = kBatch;
  while (count == kBatch) {
    count = dds_takecdr(reader, samples, kBatch, infos, DDS_ANY_STATE);
    for (int i = 0; i < count; ++i) {
      if (infos[i].valid_data && !(check_repeats_ && IsRepeated(reader, infos[i]))) {
        intake_.Deliver(AsSerdata(samples[i]).payload(), ToSourceTime(infos[i].source_timestamp));
      }
      ddsi_serdata_unref(samples[i]);
    }
  }
}

bool CycloneReader::IsRepeated(dds_entity_t reader, const dds_sample_info_t& info) try {
  const Guid& writer = WriterOf(reader, info.publication_handle);
  return !deduplicator_.IsNew(writer, info.source_timestamp);
} catch (const std::exception&) {
  return false;  // out of memory: a duplicate is better than a loss
}

/// Cyclone gives a writer a new handle when it reappears; the GUID stays the same.
const Guid& CycloneReader::WriterOf(dds_entity_t reader, dds_instance_handle_t publication) {
  const auto known = writers_.find(publication);
  if (known != writers_.end()) return known->second;
  Guid guid{};
  std::memcpy(guid.data(), &publication, sizeof publication);
  if (auto* endpoint = dds_get_matched_publication_data(reader, publication)) {
    std::memcpy(guid.data(), &endpoint->key, guid.size());
    dds_builtintopic_free_endpoint(endpoint);
  }
  if (writers_.size() >= Deduplicator::kWriters) writers_.clear();
  return writers_[publication] = guid;
}

}  // namespace conav::bus
