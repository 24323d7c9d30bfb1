#pragma once

#include "common/runtime/result.h"
#include "operator/bag/mcap_records.h"

namespace conav::bag {

/// The largest chunk that is unpacked, in bytes: nobody's memory is taken for a length that a
/// damaged file claims. Writers make chunks of a few MiB.
inline constexpr std::uint64_t kLargestChunk = std::uint64_t{256} << 20;

/// Compresses with zstd. DEMANDs that there is memory.
Bytes Compress(ByteSpan bytes, int level);

/// The records in a chunk, unpacked and checked against the chunk's size and CRC.
/// Errors: kMalformed (size, CRC, not zstd), kRefused (a compression that is not read here: only
/// zstd and none are; a chunk beyond kLargestChunk).
[[nodiscard]] Result<Bytes> Unpack(const ChunkRecord& chunk);

}  // namespace conav::bag
