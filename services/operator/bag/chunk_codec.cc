#include "operator/bag/chunk_codec.h"

#include <fmt/format.h>
#include <zstd.h>

#include "common/runtime/demand.h"

namespace conav::bag {
namespace {

Result<Bytes> Decompress(const ChunkRecord& chunk) {
  Bytes bytes(chunk.header.uncompressed_size);
  const std::size_t size =
      ZSTD_decompress(bytes.data(), bytes.size(), chunk.compressed.data(), chunk.compressed.size());
  if (ZSTD_isError(size) != 0) {
    return Fail(ErrorCode::kMalformed, fmt::format("zstd says: {}", ZSTD_getErrorName(size)));
  }
  bytes.resize(size);
  return bytes;
}

}  // namespace

Bytes Compress(ByteSpan bytes, int level) {
  Bytes compressed(ZSTD_compressBound(bytes.size()));
  const std::size_t size =
      ZSTD_compress(compressed.data(), compressed.size(), bytes.data(), bytes.size(), level);
  DEMAND(ZSTD_isError(size) == 0, ZSTD_getErrorName(size));
  compressed.resize(size);
  return compressed;
}

Result<Bytes> Unpack(const ChunkRecord& chunk) {
  const ChunkHeader& header = chunk.header;
  if (header.compression != "zstd" && !header.compression.empty()) {
    return Fail(
        ErrorCode::kRefused,
        fmt::format("compressed with '{}'; only zstd and none are read", header.compression));
  }
  if (header.uncompressed_size > kLargestChunk) {
    return Fail(ErrorCode::kRefused, fmt::format("{} bytes unpacked; {} is the limit",
                                                 header.uncompressed_size, kLargestChunk));
  }
  Result<Bytes> bytes = header.compression.empty()
                            ? Bytes(chunk.compressed.begin(), chunk.compressed.end())
                            : Decompress(chunk);
  if (!bytes) return bytes;
  if (bytes->size() != header.uncompressed_size) {
    return Fail(ErrorCode::kMalformed, fmt::format("{} bytes unpacked instead of {}", bytes->size(),
                                                   header.uncompressed_size));
  }
  if (header.uncompressed_crc != 0 && Crc32(*bytes) != header.uncompressed_crc) {
    return Fail(ErrorCode::kMalformed, "the CRC is wrong");
  }
  return bytes;
}

}  // namespace conav::bag
