#pragma once

#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/qos/DomainParticipantQos.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <map>
#include <mutex>
#include <string>

#include "common/bus/intake.h"
#include "common/bus/network.h"
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

}  // namespace conav::bus
