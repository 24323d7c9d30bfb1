#include "common/bus/fast/qos.h"

namespace conav::bus {
namespace {

namespace dds = eprosima::fastdds::dds;
using eprosima::fastrtps::Duration_t;

/// What readers and writers have in common.
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
    // Unlimited, Fast DDS slows down and grows without end when the other side does not keep up.
    result.history().kind = dds::KEEP_ALL_HISTORY_QOS;
    result.resource_limits().max_samples = kKeepAllLimit;
    result.resource_limits().max_samples_per_instance = kKeepAllLimit;
    result.resource_limits().max_instances = 1;
  }
  result.data_sharing().off();
  // The other policies refuse an empty payload, such as a dispose, and stall the writer.
  result.endpoint().history_memory_policy =
      eprosima::fastrtps::rtps::PREALLOCATED_WITH_REALLOC_MEMORY_MODE;
}

}  // namespace

dds::DataWriterQos FastWriterQos(const Qos& qos, double lease_s) {
  dds::DataWriterQos result;
  Fill(qos, result);
  result.reliability().max_blocking_time = Duration_t(0.1);
  result.liveliness().kind = dds::AUTOMATIC_LIVELINESS_QOS;
  result.liveliness().lease_duration = Duration_t(lease_s);
  result.liveliness().announcement_period = Duration_t(lease_s / 3.0);
  // How soon the loss of the last sample of a burst is noticed; 3 s by default.
  result.reliable_writer_qos().times.heartbeatPeriod = Duration_t(0.1);
  return result;
}

dds::DataReaderQos FastReaderQos(const Qos& qos) {
  dds::DataReaderQos result;
  Fill(qos, result);
  return result;
}

}  // namespace conav::bus
