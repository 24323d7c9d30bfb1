#pragma once

#include <fastrtps/utils/md5.h>

#include <algorithm>
#include <cstdint>
#include <exception>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <fastdds/dds/topic/TopicDataType.hpp>
#include <functional>
#include <iterator>

#include "common/bus/type_support.h"

// One user: what Fast DDS asks of a type and of a request's id; its entities are in participant.cc.

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

inline Guid ToGuid(const eprosima::fastrtps::rtps::GUID_t& guid) {
  Guid bytes;
  const auto entity = std::copy_n(guid.guidPrefix.value, 12, bytes.begin());
  std::copy_n(guid.entityId.value, 4, entity);
  return bytes;
}

inline eprosima::fastrtps::rtps::GUID_t ToFast(const Guid& bytes) {
  eprosima::fastrtps::rtps::GUID_t guid;
  std::copy_n(bytes.begin(), 12, guid.guidPrefix.value);
  std::copy_n(bytes.begin() + 12, 4, guid.entityId.value);
  return guid;
}

/// The id of a request or reply as ROS 2's rmw_fastrtps_cpp transports it, in the related sample
/// identity. Its client is the reader of the replies; a request's number is that of its sample.
inline eprosima::fastrtps::rtps::SampleIdentity ToIdentity(const RequestId& id) {
  eprosima::fastrtps::rtps::SampleIdentity identity;
  identity.writer_guid(ToFast(id.client));
  identity.sequence_number(
      eprosima::fastrtps::rtps::SequenceNumber_t(static_cast<std::uint64_t>(id.number)));
  return identity;
}

inline RequestId ToRequestId(const eprosima::fastrtps::rtps::SampleIdentity& identity) {
  return {ToGuid(identity.writer_guid()),
          static_cast<std::int64_t>(identity.sequence_number().to64long())};
}

/// Of a reply, and of a request, whose client may name no reader: then it is the writer.
inline RequestId IdOf(const eprosima::fastdds::dds::SampleInfo& info, bool is_reply) {
  RequestId id = ToRequestId(info.related_sample_identity);
  if (is_reply) return id;
  const RequestId sample = ToRequestId(info.sample_identity);
  if (info.related_sample_identity.writer_guid() == eprosima::fastrtps::rtps::GUID_t::unknown())
    return sample;
  return {id.client, sample.number};
}

}  // namespace conav::bus
