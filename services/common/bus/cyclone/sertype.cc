#include <cstring>
#include <new>

#include "common/bus/cyclone/serdata.h"

namespace conav::bus {
namespace {

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

// No type information is announced: matching is by name, as Fast DDS 2.9 does.
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
