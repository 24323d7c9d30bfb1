#pragma once

#include <dds/ddsi/ddsi_serdata.h>

#include <array>
#include <cstdint>
#include <span>

#include "common/bus/type_support.h"

// One user: what Cyclone DDS asks of a type; its own C API stays out of the entities.

namespace conav::bus {

/// Teaches Cyclone DDS a bus type without idlc: our own type description (sertype) and serialised
/// samples (serdata), as /usr/include/dds/ddsi/ddsi_serdata.h specifies.
///
///   ddsi_sertype, name, flags        Serdata | payload: encapsulation, CDR, padding to 4 |
///   `type` ------> TypeSupport       one allocation; freed by Cyclone's reference count
///
/// Each function that Cyclone calls catches all exceptions: one that passed through C code would
/// end the process.
struct Sertype {
  ddsi_sertype c;  // first: Cyclone only knows this part
  const TypeSupport* type;
};

/// Creates a sertype with one reference, for dds_create_topic_sertype.
ddsi_sertype* MakeSertype(const TypeSupport& type);

struct Serdata {
  ddsi_serdata c;                                 // first: Cyclone only knows this part
  std::uint32_t size;                             // of the payload, without padding
  std::uint32_t key_size;                         // 0 for types without key
  std::array<std::uint8_t, kMaximumKeySize> key;  // big-endian CDR of the key members

  std::uint8_t* bytes() { return reinterpret_cast<std::uint8_t*>(this + 1); }
  const std::uint8_t* bytes() const { return reinterpret_cast<const std::uint8_t*>(this + 1); }
  std::span<const std::uint8_t> payload() const { return {bytes(), size}; }
};

inline const Serdata& AsSerdata(const ddsi_serdata* data) {
  return *reinterpret_cast<const Serdata*>(data);
}

extern const ddsi_serdata_ops serdata_operations;

}  // namespace conav::bus
