#include "common/bus/cyclone/serdata.h"

#include <dds/ddsi/q_radmin.h>
#include <dds/ddsrt/md5.h>

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <exception>
#include <memory>
#include <new>
#include <vector>

namespace conav::bus {
namespace {

const TypeSupport& TypeOf(const ddsi_sertype* sertype) {
  return *reinterpret_cast<const Sertype*>(sertype)->type;
}

Serdata& MutableSerdata(ddsi_serdata* data) { return *reinterpret_cast<Serdata*>(data); }

constexpr std::size_t PadTo4(std::size_t size) { return (size + 3) & ~std::size_t{3}; }

/// Zeroed padding, uninitialised payload, no key. Throws std::bad_alloc.
Serdata* Allocate(const ddsi_sertype* type, ddsi_serdata_kind kind, std::size_t size) {
  auto* serdata = static_cast<Serdata*>(::operator new(sizeof(Serdata) + PadTo4(size)));
  ddsi_serdata_init(&serdata->c, type, kind);
  serdata->c.hash = type->serdata_basehash;
  serdata->size = static_cast<std::uint32_t>(size);
  serdata->key_size = 0;
  std::memset(serdata->bytes() + size, 0, PadTo4(size) - size);
  return serdata;
}

void Free(ddsi_serdata* data) { ::operator delete(&MutableSerdata(data)); }

/// FNV-1a.
std::uint32_t HashOf(std::span<const std::uint8_t> bytes) {
  std::uint32_t hash = 2166136261u;
  for (const std::uint8_t byte : bytes) hash = (hash ^ byte) * 16777619u;
  return hash;
}

void SetKey(Serdata& serdata, const void* message) {
  const TypeSupport& type = TypeOf(serdata.c.type);
  serdata.key.fill(0);
  serdata.key_size = static_cast<std::uint32_t>(type.serialize_key(message, serdata.key));
  serdata.c.hash ^= HashOf({serdata.key.data(), serdata.key_size});
}

/// Sets the key of a sample from the network. A key-only payload (a dispose) is read as a message
/// whose other members are zero, which is right when the keys are declared first.
/// An undecodable payload gets the zero key; the reader finds out and drops it.
void SetKeyFromPayload(Serdata& serdata) {
  const TypeSupport& type = TypeOf(serdata.c.type);
  if (!type.keyed) return;
  constexpr std::size_t kRoomForEmptyMembers = 512;
  std::vector<std::uint8_t> padded;
  std::span<const std::uint8_t> payload = serdata.payload();
  if (serdata.c.kind == SDK_KEY) {
    padded.assign(payload.begin(), payload.end());
    padded.resize(payload.size() + kRoomForEmptyMembers);
    payload = padded;
  }
  const std::unique_ptr<void, void (*)(void*)> message(type.create(), type.destroy);
  static_cast<void>(type.deserialize(payload, message.get()));
  SetKey(serdata, message.get());
}

ddsi_serdata* FromFragments(const ddsi_sertype* type, ddsi_serdata_kind kind,
                            const nn_rdata* fragment, size_t size) try {
  Serdata* serdata = Allocate(type, kind, size);
  std::uint32_t offset = 0;
  for (; fragment != nullptr; fragment = fragment->nextfrag) {
    if (fragment->maxp1 <= offset) continue;
    const unsigned char* payload =
        NN_RMSG_PAYLOADOFF(fragment->rmsg, NN_RDATA_PAYLOAD_OFF(fragment));
    std::memcpy(serdata->bytes() + offset, payload + (offset - fragment->min),
                fragment->maxp1 - offset);
    offset = fragment->maxp1;
  }
  SetKeyFromPayload(*serdata);
  return &serdata->c;
} catch (const std::exception&) {
  return nullptr;
}

ddsi_serdata* FromVectors(const ddsi_sertype* type, ddsi_serdata_kind kind,
                          ddsrt_msg_iovlen_t count, const ddsrt_iovec_t* vectors, size_t size) try {
  Serdata* serdata = Allocate(type, kind, size);
  std::size_t offset = 0;
  for (ddsrt_msg_iovlen_t i = 0; i < count && offset < size; ++i) {
    const std::size_t length = std::min<std::size_t>(vectors[i].iov_len, size - offset);
    std::memcpy(serdata->bytes() + offset, vectors[i].iov_base, length);
    offset += length;
  }
  SetKeyFromPayload(*serdata);
  return &serdata->c;
} catch (const std::exception&) {
  return nullptr;
}

/// A key hash is the key itself: keys have at most 16 bytes.
ddsi_serdata* FromKeyhash(const ddsi_sertype* type, const ddsi_keyhash* keyhash) try {
  Serdata* serdata = Allocate(type, SDK_KEY, kEncapsulationSize + kMaximumKeySize);
  const std::uint8_t big_endian[kEncapsulationSize] = {0, 0, 0, 0};
  std::memcpy(serdata->bytes(), big_endian, sizeof big_endian);
  std::memcpy(serdata->bytes() + kEncapsulationSize, keyhash->value, kMaximumKeySize);
  SetKeyFromPayload(*serdata);
  return &serdata->c;
} catch (const std::exception&) {
  return nullptr;
}

/// Fast DDS mistakes key payloads of up to 16 bytes, encapsulation included, for the key hash
/// itself. So our key payloads are always longer, and Fast DDS uses the key hash parameter instead.
ddsi_serdata* KeyOf(const ddsi_sertype* type, const void* message) {
  Serdata* serdata = Allocate(type, SDK_KEY, kEncapsulationSize + kMaximumKeySize);
  std::memset(serdata->bytes(), 0, serdata->size);
  if (TypeOf(type).keyed) SetKey(*serdata, message);
  std::copy_n(serdata->key.begin(), serdata->key_size, serdata->bytes() + kEncapsulationSize);
  return &serdata->c;
}

ddsi_serdata* FromSample(const ddsi_sertype* sertype, ddsi_serdata_kind kind,
                         const void* message) try {
  if (kind != SDK_DATA) return KeyOf(sertype, message);
  const TypeSupport& type = TypeOf(sertype);
  Serdata* serdata = Allocate(sertype, kind, PayloadSize(type, message));
  const std::size_t written = ToPayload(type, message, {serdata->bytes(), serdata->size});
  if (written == 0) {
    Free(&serdata->c);
    return nullptr;
  }
  std::memset(serdata->bytes() + written, 0, PadTo4(serdata->size) - written);
  serdata->size = static_cast<std::uint32_t>(written);
  if (type.keyed) SetKey(*serdata, message);
  return &serdata->c;
} catch (const std::exception&) {
  return nullptr;
}

/// Keeps only the key, which all topics of the instance map share.
ddsi_serdata* ToUntyped(const ddsi_serdata* data) try {
  const Serdata& full = AsSerdata(data);
  Serdata* serdata = Allocate(data->type, SDK_KEY, 0);
  serdata->c.type = nullptr;
  serdata->c.hash = data->hash;
  serdata->key = full.key;
  serdata->key_size = full.key_size;
  return &serdata->c;
} catch (const std::exception&) {
  return nullptr;
}

std::uint32_t Size(const ddsi_serdata* data) { return AsSerdata(data).size; }

void ToBuffer(const ddsi_serdata* data, size_t offset, size_t size, void* buffer) {
  std::memcpy(buffer, AsSerdata(data).bytes() + offset, size);
}

ddsi_serdata* ToReference(const ddsi_serdata* data, size_t offset, size_t size,
                          ddsrt_iovec_t* reference) {
  reference->iov_base = const_cast<std::uint8_t*>(AsSerdata(data).bytes()) + offset;
  reference->iov_len = size;
  return ddsi_serdata_ref(data);
}

void EndReference(ddsi_serdata* data, const ddsrt_iovec_t*) { ddsi_serdata_unref(data); }

bool ToSample(const ddsi_serdata* data, void* message, void**, void*) {
  return TypeOf(data->type).deserialize(AsSerdata(data).payload(), message);
}

bool UntypedToSample(const ddsi_sertype*, const ddsi_serdata*, void*, void**, void*) {
  return false;  // the bus does not read samples without data
}

bool EqualKey(const ddsi_serdata* a, const ddsi_serdata* b) {
  const Serdata& left = AsSerdata(a);
  const Serdata& right = AsSerdata(b);
  return left.key_size == right.key_size &&
         std::equal(left.key.begin(), left.key.begin() + left.key_size, right.key.begin());
}

size_t Print(const ddsi_sertype* type, const ddsi_serdata* data, char* text, size_t size) {
  const char* name = type != nullptr ? TypeOf(type).name.c_str() : "key";
  return static_cast<size_t>(std::snprintf(text, size, "%s of %u bytes", name, Size(data)));
}

void KeyHash(const ddsi_serdata* data, ddsi_keyhash* hash, bool force_md5) {
  const Serdata& serdata = AsSerdata(data);
  std::memset(hash->value, 0, sizeof hash->value);
  if (!force_md5) {
    std::copy_n(serdata.key.begin(), serdata.key_size, hash->value);
    return;
  }
  ddsrt_md5_state_t state;
  ddsrt_md5_init(&state);
  ddsrt_md5_append(&state, serdata.key.data(), serdata.key_size);
  ddsrt_md5_finish(&state, hash->value);
}

Sertype& AsSertype(ddsi_sertype* type) { return *reinterpret_cast<Sertype*>(type); }
const Sertype& AsSertype(const ddsi_sertype* type) {
  return *reinterpret_cast<const Sertype*>(type);
}

void Free(ddsi_sertype* type) {
  ddsi_sertype_fini(type);
  delete &AsSertype(type);
}

// The bus reads with dds_takecdr, so Cyclone never handles samples by itself.
void ZeroSamples(const ddsi_sertype*, void*, size_t) {}
void ReallocSamples(void**, const ddsi_sertype*, void*, size_t, size_t) {}
void FreeSamples(const ddsi_sertype*, void**, size_t, dds_free_op_t) {}

bool Equal(const ddsi_sertype* a, const ddsi_sertype* b) {
  return AsSertype(a).type == AsSertype(b).type;
}

std::uint32_t Hash(const ddsi_sertype*) { return 0; }

// No type information is announced: matching is by name, as in Fast DDS 2.9.
const ddsi_sertype_ops sertype_operations = {
    .version = ddsi_sertype_v0,
    .arg = nullptr,
    .free = Free,
    .zero_samples = ZeroSamples,
    .realloc_samples = ReallocSamples,
    .free_samples = FreeSamples,
    .equal = Equal,
    .hash = Hash,
    .type_id = nullptr,
    .type_map = nullptr,
    .type_info = nullptr,
    .derive_sertype = nullptr,
    .get_serialized_size = nullptr,
    .serialize_into = nullptr,
};

}  // namespace

const ddsi_serdata_ops serdata_operations = {
    .eqkey = EqualKey,
    .get_size = Size,
    .from_ser = FromFragments,
    .from_ser_iov = FromVectors,
    .from_keyhash = FromKeyhash,
    .from_sample = FromSample,
    .to_ser = ToBuffer,
    .to_ser_ref = ToReference,
    .to_ser_unref = EndReference,
    .to_sample = ToSample,
    .to_untyped = ToUntyped,
    .untyped_to_sample = UntypedToSample,
    .free = Free,
    .print = Print,
    .get_keyhash = KeyHash,
    // Shared memory stays off.
    .get_sample_size = nullptr,
    .from_iox_buffer = nullptr,
};

ddsi_sertype* MakeSertype(const TypeSupport& type) {
  auto* sertype = new Sertype{};
  sertype->type = &type;
  const std::uint32_t flags = type.keyed ? 0 : DDSI_SERTYPE_FLAG_TOPICKIND_NO_KEY;
  ddsi_sertype_init_flags(&sertype->c, type.name.c_str(), &sertype_operations, &serdata_operations,
                          flags);
  sertype->c.allowed_data_representation = DDS_DATA_REPRESENTATION_FLAG_XCDR1;
  return &sertype->c;
}

}  // namespace conav::bus
