#pragma once

#include <fastrtps/utils/md5.h>

#include <algorithm>
#include <fastdds/dds/topic/TopicDataType.hpp>
#include <functional>
#include <iterator>
#include <span>

#include "common/bus/type_support.h"

// One user: what Fast DDS asks of a type.

namespace conav::bus {

/// A message of the bus, by reference: what Fast DDS handles as a sample.
struct FastSample {
  void* message = nullptr;
  /// After a read: whether the payload was a message. ErasedType always reports success to Fast
  /// DDS, so that the reader of the bus takes and drops a malformed sample like any other.
  bool valid = false;
};

inline FastSample& SampleOf(void* data) { return *static_cast<FastSample*>(data); }

/// One TopicDataType for all types of the bus, instead of fastddsgen's PubSubTypes. Never throws
/// into Fast DDS.
class ErasedType final : public eprosima::fastdds::dds::TopicDataType {
 public:
  explicit ErasedType(const TypeSupport& type) : type_(type) {
    setName(type.name.c_str());
    m_typeSize = 1024;  // Fast DDS first allocates this for each sample and grows it on demand
    m_isGetKeyDefined = type.keyed;
  }

  bool serialize(void* sample, eprosima::fastrtps::rtps::SerializedPayload_t* payload) override {
    const std::size_t written =
        type_.serialize(SampleOf(sample).message, {payload->data, payload->max_size});
    payload->encapsulation = CDR_LE;
    payload->length = static_cast<std::uint32_t>(written);
    return written != 0;
  }
  bool deserialize(eprosima::fastrtps::rtps::SerializedPayload_t* payload, void* sample) override {
    FastSample& target = SampleOf(sample);
    target.valid = type_.deserialize({payload->data, payload->length}, target.message);
    return true;
  }
  std::function<std::uint32_t()> getSerializedSizeProvider(void* sample) override {
    return [this, message = SampleOf(sample).message] {
      return static_cast<std::uint32_t>(type_.serialized_size(message));
    };
  }
  void* createData() override try {
    return new FastSample{type_.create(), false};
  } catch (const std::exception&) {
    return nullptr;
  }
  void deleteData(void* sample) override {
    type_.destroy(SampleOf(sample).message);
    delete static_cast<FastSample*>(sample);
  }
  bool getKey(void* sample, eprosima::fastrtps::rtps::InstanceHandle_t* handle,
              bool force_md5) override {
    if (!type_.keyed) return false;
    std::uint8_t key[kMaximumKeySize] = {};
    const std::size_t size = type_.serialize_key(SampleOf(sample).message, std::span(key));
    if (force_md5) {
      MD5 md5;
      md5.init();
      md5.update(key, static_cast<unsigned>(size));
      md5.finalize();
      std::copy(std::begin(md5.digest), std::end(md5.digest), key);
    }
    for (std::size_t i = 0; i < kMaximumKeySize; ++i) handle->value[i] = key[i];
    return true;
  }

  const TypeSupport& type() const { return type_; }

 private:
  const TypeSupport& type_;
};

}  // namespace conav::bus
