#pragma once

#include <fastdds/dds/domain/qos/DomainParticipantQos.hpp>
#include <fastdds/dds/publisher/qos/DataWriterQos.hpp>
#include <fastdds/dds/subscriber/qos/DataReaderQos.hpp>
#include <string>

#include "common/bus/network.h"
#include "common/bus/qos.h"

// One user: qos.cc, whose functions participant.cc and the benchmark of the bus call.

/// The settings of Fast DDS, which the benchmark of the bus uses as well.
namespace conav::bus {

/// Network, discovery and lease of a Fast DDS participant. UDP only: shared memory
/// gains little here and leaves segments behind when a process is killed.
eprosima::fastdds::dds::DomainParticipantQos FastParticipantQos(const std::string& node_name,
                                                                const Network& network,
                                                                double lease_s);

/// The same of resolved options, with its user data and security. Throws StartupError (FindEnclave).
eprosima::fastdds::dds::DomainParticipantQos FastParticipantQos(const std::string& node_name,
                                                                const ParticipantOptions& options);

/// `loopback`: Network::loopback.
eprosima::fastdds::dds::DataWriterQos FastWriterQos(const Qos& qos, bool loopback, double lease_s);
eprosima::fastdds::dds::DataReaderQos FastReaderQos(const Qos& qos);

}  // namespace conav::bus
