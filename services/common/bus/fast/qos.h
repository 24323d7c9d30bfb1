#pragma once

#include <fastdds/dds/publisher/qos/DataWriterQos.hpp>
#include <fastdds/dds/subscriber/qos/DataReaderQos.hpp>

#include "common/bus/qos.h"

namespace conav::bus {

eprosima::fastdds::dds::DataWriterQos FastWriterQos(const Qos& qos, double lease_s);
eprosima::fastdds::dds::DataReaderQos FastReaderQos(const Qos& qos);

}  // namespace conav::bus
