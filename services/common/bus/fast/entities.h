#pragma once

#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/DataWriterListener.hpp>
#include <fastdds/dds/publisher/qos/DataWriterQos.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/DataReaderListener.hpp>
#include <fastdds/dds/subscriber/qos/DataReaderQos.hpp>

#include "common/bus/backend.h"
#include "common/bus/events.h"
#include "common/bus/fast/participant.h"
#include "common/bus/intake.h"
#include "common/bus/qos.h"
#include "common/bus/ros_graph.h"

namespace conav::bus {

eprosima::fastdds::dds::DataWriterQos FastWriterQos(const Qos& qos, double lease_s);
eprosima::fastdds::dds::DataReaderQos FastReaderQos(const Qos& qos);

/// The state that the endpoints of one participant share. Outlives them.
struct FastContext {
  FastParticipant& participant;
  double lease_s;
  EventLog& events;
  RosGraph* graph;  // null for endpoints that ROS tools do not see
};

class FastWriter final : public Writer, private eprosima::fastdds::dds::DataWriterListener {
 public:
  FastWriter(const FastContext& context, const EndpointOptions& options);
  ~FastWriter() override;

  Result<void> Write(const void* message) override;
  bool WaitForAcknowledgments(std::chrono::nanoseconds timeout) override;
  int matched() const override;

 private:
  void on_publication_matched(
      eprosima::fastdds::dds::DataWriter* writer,
      const eprosima::fastdds::dds::PublicationMatchedStatus& status) override;
  void on_offered_incompatible_qos(
      eprosima::fastdds::dds::DataWriter* writer,
      const eprosima::fastdds::dds::OfferedIncompatibleQosStatus& status) override;

  FastContext context_;
  EndpointOptions options_;
  EndpointEvents events_;
  eprosima::fastdds::dds::Topic* topic_;
  eprosima::fastdds::dds::DataWriter* writer_;
};

class FastReader final : public Reader, private eprosima::fastdds::dds::DataReaderListener {
 public:
  FastReader(const FastContext& context, const EndpointOptions& options, Sink sink);
  ~FastReader() override;

  int matched() const override;
  std::uint64_t malformed() const override { return intake_.malformed(); }

 private:
  void on_data_available(eprosima::fastdds::dds::DataReader* reader) override;
  void on_subscription_matched(
      eprosima::fastdds::dds::DataReader* reader,
      const eprosima::fastdds::dds::SubscriptionMatchedStatus& status) override;
  void on_liveliness_changed(
      eprosima::fastdds::dds::DataReader* reader,
      const eprosima::fastdds::dds::LivelinessChangedStatus& status) override;
  void on_requested_incompatible_qos(
      eprosima::fastdds::dds::DataReader* reader,
      const eprosima::fastdds::dds::RequestedIncompatibleQosStatus& status) override;

  bool TakeOne(eprosima::fastdds::dds::DataReader& reader);
  bool IsRepeated(const eprosima::fastdds::dds::SampleInfo& info);

  FastContext context_;
  EndpointEvents events_;
  Intake intake_;
  const bool check_repeats_;  // vendors only repeat transient-local history
  Deduplicator deduplicator_;
  eprosima::fastdds::dds::Topic* topic_;
  eprosima::fastdds::dds::DataReader* reader_;
};

}  // namespace conav::bus
