#pragma once

#include <fastdds/dds/topic/TopicDataType.hpp>

#include "common/bus/type_support.h"

// One user: what Fast DDS asks of a type, apart from its entities.

namespace conav::bus {

/// A message of the bus, by reference: what Fast DDS handles as a sample.
struct FastSample {
  void* message = nullptr;
  /// After a read: whether the payload was a message. ErasedType always reports success to Fast
  /// DDS, so that the reader of the bus takes and drops a malformed sample like any other.
  bool valid = false;
};

/// One TopicDataType for all types of the bus, instead of fastddsgen's PubSubTypes. Never throws
/// into Fast DDS.
class ErasedType final : public eprosima::fastdds::dds::TopicDataType {
 public:
  explicit ErasedType(const TypeSupport& type);

  bool serialize(void* sample, eprosima::fastrtps::rtps::SerializedPayload_t* payload) override;
  bool deserialize(eprosima::fastrtps::rtps::SerializedPayload_t* payload, void* sample) override;
  std::function<std::uint32_t()> getSerializedSizeProvider(void* sample) override;
  void* createData() override;
  void deleteData(void* sample) override;
  bool getKey(void* sample, eprosima::fastrtps::rtps::InstanceHandle_t* handle,
              bool force_md5) override;

  const TypeSupport& type() const { return type_; }

 private:
  const TypeSupport& type_;
};

}  // namespace conav::bus
