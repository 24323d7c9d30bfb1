#include "common/bus/fast/erased_type.h"

#include <fastrtps/utils/md5.h>

#include <algorithm>
#include <exception>
#include <span>

namespace conav::bus {
namespace {

using eprosima::fastrtps::rtps::InstanceHandle_t;
using eprosima::fastrtps::rtps::SerializedPayload_t;

/// Fast DDS first allocates this much for each sample and grows it on demand.
constexpr std::uint32_t kUsualPayloadSize = 1024;

FastSample& SampleOf(void* data) { return *static_cast<FastSample*>(data); }

}  // namespace

ErasedType::ErasedType(const TypeSupport& type) : type_(type) {
  setName(type.name.c_str());
  m_typeSize = kUsualPayloadSize;
  m_isGetKeyDefined = type.keyed;
}

bool ErasedType::serialize(void* sample, SerializedPayload_t* payload) {
  const std::size_t written =
      type_.serialize(SampleOf(sample).message, {payload->data, payload->max_size});
  payload->encapsulation = CDR_LE;
  payload->length = static_cast<std::uint32_t>(written);
  return written != 0;
}

bool ErasedType::deserialize(SerializedPayload_t* payload, void* sample) {
  FastSample& target = SampleOf(sample);
  target.valid = type_.deserialize({payload->data, payload->length}, target.message);
  return true;
}

std::function<std::uint32_t()> ErasedType::getSerializedSizeProvider(void* sample) {
  return [this, message = SampleOf(sample).message] {
    return static_cast<std::uint32_t>(type_.serialized_size(message));
  };
}

void* ErasedType::createData() try {
  return new FastSample{type_.create(), false};
} catch (const std::exception&) {
  return nullptr;
}

void ErasedType::deleteData(void* sample) {
  type_.destroy(SampleOf(sample).message);
  delete static_cast<FastSample*>(sample);
}

bool ErasedType::getKey(void* sample, InstanceHandle_t* handle, bool force_md5) {
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

}  // namespace conav::bus
