#pragma once

#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/qos/DomainParticipantQos.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/DataWriterListener.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/publisher/qos/DataWriterQos.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/DataReaderListener.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <fastdds/dds/subscriber/qos/DataReaderQos.hpp>
#include <map>
#include <mutex>
#include <string>

#include "common/bus/backend.h"
#include "common/bus/events.h"
#include "common/bus/intake.h"
#include "common/bus/network.h"
#include "common/bus/qos.h"
#include "common/bus/ros_graph.h"
#include "common/bus/type_support.h"

namespace conav::bus {

/// Network, discovery, lease and ROS user data of a Fast DDS participant. UDP only: shared memory
/// gains little here and leaves segments behind when a process is killed.
eprosima::fastdds::dds::DomainParticipantQos FastParticipantQos(const std::string& node_name,
                                                                const Network& network,
                                                                double lease_s);

Guid ToGuid(const eprosima::fastrtps::rtps::GUID_t& guid);

/// A Fast DDS participant with one publisher, one subscriber, and the topics in use.
/// Threads: safe to call concurrently.
class FastParticipant {
 public:
  /// Throws StartupError.
  FastParticipant(int domain_id, const eprosima::fastdds::dds::DomainParticipantQos& qos);
  ~FastParticipant();
  FastParticipant(const FastParticipant&) = delete;
  FastParticipant& operator=(const FastParticipant&) = delete;

  /// Returns the one topic object per name that Fast DDS allows, and counts its users. `type` lives
  /// as long as the program. Throws StartupError.
  eprosima::fastdds::dds::Topic* AcquireTopic(const std::string& dds_name, const TypeSupport& type);
  void ReleaseTopic(eprosima::fastdds::dds::Topic* topic);

  eprosima::fastdds::dds::Publisher& publisher() { return *publisher_; }
  eprosima::fastdds::dds::Subscriber& subscriber() { return *subscriber_; }
  Guid guid() const { return ToGuid(participant_->guid()); }

 private:
  void Close();

  eprosima::fastdds::dds::DomainParticipant* participant_;
  eprosima::fastdds::dds::Publisher* publisher_;
  eprosima::fastdds::dds::Subscriber* subscriber_;
  std::mutex mutex_;  // guards users_
  std::map<eprosima::fastdds::dds::Topic*, int> users_;
};

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
