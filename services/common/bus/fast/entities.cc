#include "common/bus/fast/entities.h"

#include <fmt/format.h>

#include "common/bus/fast/erased_type.h"
#include "common/bus/network.h"
#include "common/runtime/log.h"

namespace conav::bus {
namespace {

namespace dds = eprosima::fastdds::dds;
using eprosima::fastrtps::Duration_t;

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
  result.endpoint().history_memory_policy =
      eprosima::fastrtps::rtps::PREALLOCATED_WITH_REALLOC_MEMORY_MODE;
}

namespace dds = eprosima::fastdds::dds;
using eprosima::fastrtps::types::ReturnCode_t;

/// Fast DDS sometimes rejects a sample for a full keep-all history long before max_blocking_time.
constexpr int kWriteAttempts = 3;

dds::StatusMask WriterEvents() {
  return dds::StatusMask::publication_matched() << dds::StatusMask::offered_incompatible_qos();
}

dds::StatusMask ReaderEvents() {
  return dds::StatusMask::data_available()
         << dds::StatusMask::subscription_matched() << dds::StatusMask::liveliness_changed()
         << dds::StatusMask::requested_incompatible_qos();
}

std::string Describe(const ReturnCode_t& code) {
  if (code == ReturnCode_t::RETCODE_TIMEOUT) return "queue full";
  if (code == ReturnCode_t::RETCODE_OUT_OF_RESOURCES) return "out of resources";
  return fmt::format("return code {}", code());
}

}  // namespace

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

FastWriter::FastWriter(const FastContext& context, const EndpointOptions& options)
    : context_(context),
      options_(options),
      events_(context.events, options.topic),
      topic_(context.participant.AcquireTopic(DdsTopicName(options.topic), options.type)),
      writer_(context.participant.publisher().create_datawriter(
          topic_, FastWriterQos(options.qos, context.lease_s), this, WriterEvents())) {
  if (writer_ == nullptr) {
    context_.participant.ReleaseTopic(topic_);
    throw StartupError("Fast DDS cannot create a writer for " + options.topic);
  }
  if (context_.graph != nullptr) context_.graph->AddWriter(ToGuid(writer_->guid()));
}

FastWriter::~FastWriter() {
  if (context_.graph != nullptr) context_.graph->RemoveWriter(ToGuid(writer_->guid()));
  writer_->set_listener(nullptr);
  context_.participant.publisher().delete_datawriter(writer_);
  context_.participant.ReleaseTopic(topic_);
}

Result<void> FastWriter::Write(const void* message) {
  FastSample sample{const_cast<void*>(message), true};
  ReturnCode_t code = ReturnCode_t::RETCODE_TIMEOUT;
  for (int i = 0; i < kWriteAttempts && code == ReturnCode_t::RETCODE_TIMEOUT; ++i) {
    code = writer_->write(&sample, eprosima::fastrtps::rtps::c_InstanceHandle_Unknown);
  }
  if (code == ReturnCode_t::RETCODE_OK) return {};
  if (code == ReturnCode_t::RETCODE_ERROR) {
    return Fail(ErrorCode::kMalformed, "a message for " + options_.topic + " cannot be serialised");
  }
  return Fail(ErrorCode::kUnavailable,
              fmt::format("{} did not take a message: {}", options_.topic, Describe(code)));
}

bool FastWriter::WaitForAcknowledgments(std::chrono::nanoseconds timeout) {
  const std::chrono::duration<long double> seconds = timeout;
  return writer_->wait_for_acknowledgments(eprosima::fastrtps::Duration_t(seconds.count())) ==
         ReturnCode_t::RETCODE_OK;
}

int FastWriter::matched() const {
  dds::PublicationMatchedStatus status;
  writer_->get_publication_matched_status(status);
  return status.current_count;
}

void FastWriter::on_publication_matched(dds::DataWriter*,
                                        const dds::PublicationMatchedStatus& status) {
  events_.Matched(status.current_count_change);
}

void FastWriter::on_offered_incompatible_qos(dds::DataWriter*,
                                             const dds::OfferedIncompatibleQosStatus& status) {
  events_.IncompatibleQos(status.last_policy_id);
}

FastReader::FastReader(const FastContext& context, const EndpointOptions& options, Sink sink)
    : context_(context),
      events_(context.events, options.topic),
      intake_(options, std::move(sink), context.events),
      check_repeats_(options.qos.durability == Durability::kTransientLocal),
      topic_(context.participant.AcquireTopic(DdsTopicName(options.topic), options.type)),
      reader_(context.participant.subscriber().create_datareader(topic_, FastReaderQos(options.qos),
                                                                 this, ReaderEvents())) {
  if (reader_ == nullptr) {
    context_.participant.ReleaseTopic(topic_);
    throw StartupError("Fast DDS cannot create a reader for " + options.topic);
  }
  if (context_.graph != nullptr) context_.graph->AddReader(ToGuid(reader_->guid()));
}

FastReader::~FastReader() {
  if (context_.graph != nullptr) context_.graph->RemoveReader(ToGuid(reader_->guid()));
  reader_->set_listener(nullptr);
  context_.participant.subscriber().delete_datareader(reader_);
  context_.participant.ReleaseTopic(topic_);
}

int FastReader::matched() const {
  dds::SubscriptionMatchedStatus status;
  reader_->get_subscription_matched_status(status);
  return status.current_count;
}

void FastReader::on_data_available(dds::DataReader* reader) try {
  while (TakeOne(*reader)) {
  }
} catch (const std::exception& error) {
  LOG_ERROR("messages lost", "topic", events_.topic(), "reason", error.what());
}

bool FastReader::TakeOne(dds::DataReader& reader) {
  FastSample sample{intake_.Acquire(), false};
  dds::SampleInfo info;
  if (reader.take_next_sample(&sample, &info) != ReturnCode_t::RETCODE_OK) {
    intake_.Discard(sample.message);
    return false;
  }
  if (!info.valid_data || (check_repeats_ && IsRepeated(info))) {
    intake_.Discard(sample.message);
  } else if (sample.valid) {
    intake_.Accept(sample.message, ToSourceTime(info.source_timestamp.to_ns()));
  } else {
    intake_.Refuse(sample.message);
  }
  return true;
}

bool FastReader::IsRepeated(const dds::SampleInfo& info) {
  const auto& identity = info.sample_identity;
  const auto number = static_cast<std::int64_t>(identity.sequence_number().to64long());
  return !deduplicator_.IsNew(ToGuid(identity.writer_guid()), number);
}

void FastReader::on_subscription_matched(dds::DataReader*,
                                         const dds::SubscriptionMatchedStatus& status) {
  events_.Matched(status.current_count_change);
}

void FastReader::on_liveliness_changed(dds::DataReader*,
                                       const dds::LivelinessChangedStatus& status) {
  events_.Liveliness(status.alive_count_change, status.not_alive_count_change);
}

void FastReader::on_requested_incompatible_qos(dds::DataReader*,
                                               const dds::RequestedIncompatibleQosStatus& status) {
  events_.IncompatibleQos(status.last_policy_id);
}

}  // namespace conav::bus
