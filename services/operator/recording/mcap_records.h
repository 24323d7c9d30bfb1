#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "common/runtime/result.h"

/// Little-endian numbers and length-prefixed texts, as MCAP has them.
namespace conav::bag {

using Bytes = std::vector<std::uint8_t>;
using ByteSpan = std::span<const std::uint8_t>;
using TextMap = std::map<std::string, std::string>;

class ByteWriter {
 public:
  /// Appends to `bytes`, which outlives it.
  explicit ByteWriter(Bytes& bytes) : bytes_(bytes) {}

  void U8(std::uint8_t value) { Number(value, 1); }
  void U16(std::uint16_t value) { Number(value, 2); }
  void U32(std::uint32_t value) { Number(value, 4); }
  void U64(std::uint64_t value) { Number(value, 8); }
  void Raw(ByteSpan bytes) { bytes_.insert(bytes_.end(), bytes.begin(), bytes.end()); }
  void Text(std::string_view text) {
    U32(static_cast<std::uint32_t>(text.size()));
    bytes_.insert(bytes_.end(), text.begin(), text.end());
  }
  void Map(const TextMap& map) {
    const std::size_t length_at = BeginLength(4);
    for (const auto& [key, value] : map) {
      Text(key);
      Text(value);
    }
    EndLength(length_at, 4);
  }

  /// A length of `width` bytes that EndLength fills in with what was appended since.
  std::size_t BeginLength(int width) {
    const std::size_t at = bytes_.size();
    Number(0, width);
    return at;
  }
  void EndLength(std::size_t at, int width) {
    std::uint64_t length = bytes_.size() - at - static_cast<std::size_t>(width);
    for (int i = 0; i < width; ++i, length >>= 8) {
      bytes_[at + static_cast<std::size_t>(i)] = static_cast<std::uint8_t>(length);
    }
  }

 private:
  void Number(std::uint64_t value, int width) {
    for (int i = 0; i < width; ++i, value >>= 8) bytes_.push_back(static_cast<std::uint8_t>(value));
  }

  Bytes& bytes_;
};

/// Reads zeros and nothing beyond the end, and ok() says afterwards whether it came to that.
class ByteReader {
 public:
  explicit ByteReader(ByteSpan bytes) : bytes_(bytes) {}

  std::uint8_t U8() { return static_cast<std::uint8_t>(Number(1)); }
  std::uint16_t U16() { return static_cast<std::uint16_t>(Number(2)); }
  std::uint32_t U32() { return static_cast<std::uint32_t>(Number(4)); }
  std::uint64_t U64() { return Number(8); }
  ByteSpan Raw(std::uint64_t size) {
    if (size > bytes_.size()) {
      ok_ = false;
      bytes_ = {};
      return {};
    }
    const ByteSpan taken = bytes_.first(static_cast<std::size_t>(size));
    bytes_ = bytes_.subspan(taken.size());
    return taken;
  }
  std::string Text() {
    const ByteSpan text = Raw(U32());
    return {text.begin(), text.end()};
  }
  TextMap Map() {
    ByteReader inner(Raw(U32()));
    TextMap map;
    while (!inner.at_end()) {
      std::string key = inner.Text();
      map[std::move(key)] = inner.Text();
    }
    ok_ = ok_ && inner.ok();
    return map;
  }

  bool at_end() const { return bytes_.empty(); }
  bool ok() const { return ok_; }
  std::size_t left() const { return bytes_.size(); }

 private:
  std::uint64_t Number(std::size_t width) {
    std::uint64_t value = 0;
    const ByteSpan bytes = Raw(width);
    for (std::size_t i = bytes.size(); i-- > 0;) value = value << 8 | bytes[i];
    return value;
  }

  ByteSpan bytes_;
  bool ok_ = true;
};

}  // namespace conav::bag

/// The records of an MCAP file, version 0 (the format of Foxglove and of rosbag2's "mcap" storage):
///
///   magic | Header Metadata... (Chunk MessageIndex...)... DataEnd | summary: Schema... Channel...
///   Statistics ChunkIndex... MetadataIndex... SummaryOffset... | Footer | magic
///
/// Each record is an opcode (1 byte), the length of its content (8) and the content. A chunk holds
/// schemas, channels and messages as records, compressed together. All times are nanoseconds.
namespace conav::bag {

inline constexpr std::uint8_t kMagic[] = {0x89, 'M', 'C', 'A', 'P', '0', '\r', '\n'};
inline constexpr std::size_t kMagicSize = sizeof kMagic;
inline constexpr std::size_t kRecordHeaderSize = 9;
inline constexpr std::size_t kFooterSize = 20;  // its content

enum class Opcode : std::uint8_t {
  kHeader = 0x01,
  kFooter = 0x02,
  kSchema = 0x03,
  kChannel = 0x04,
  kMessage = 0x05,
  kChunk = 0x06,
  kMessageIndex = 0x07,
  kChunkIndex = 0x08,
  kStatistics = 0x0B,
  kMetadata = 0x0C,
  kMetadataIndex = 0x0D,
  kSummaryOffset = 0x0E,
  kDataEnd = 0x0F,
};

struct Schema {
  std::uint16_t id = 0;
  std::string name;      // "conav_msgs/msg/RobotState"
  std::string encoding;  // "ros2msg"
  std::string text;
};

struct Channel {
  std::uint16_t id = 0;
  std::uint16_t schema_id = 0;
  std::string topic;
  std::string message_encoding;  // "cdr"
  TextMap metadata;
};

struct MessageHeader {
  std::uint16_t channel_id = 0;
  std::uint32_t sequence = 0;
  std::uint64_t log_time = 0;
  std::uint64_t publish_time = 0;
};

/// A chunk without its bytes.
struct ChunkHeader {
  std::uint64_t start_time = 0;
  std::uint64_t end_time = 0;
  std::uint64_t uncompressed_size = 0;
  std::uint32_t uncompressed_crc = 0;  // 0 = not known
  std::string compression;             // "zstd", "lz4" or empty
};

struct ChunkIndex {
  std::uint64_t start_time = 0;
  std::uint64_t end_time = 0;
  std::uint64_t offset = 0;  // of the chunk record in the file
  std::uint64_t length = 0;  // of the whole record
  std::map<std::uint16_t, std::uint64_t> message_index_offsets;
  std::uint64_t message_index_length = 0;
  std::string compression;
  std::uint64_t compressed_size = 0;
  std::uint64_t uncompressed_size = 0;
};

struct Statistics {
  std::uint64_t message_count = 0;
  std::uint16_t schema_count = 0;
  std::uint32_t channel_count = 0;
  std::uint32_t attachment_count = 0;
  std::uint32_t metadata_count = 0;
  std::uint32_t chunk_count = 0;
  std::uint64_t start_time = 0;
  std::uint64_t end_time = 0;
  std::map<std::uint16_t, std::uint64_t> channel_counts;
};

struct Metadata {
  std::string name;
  TextMap values;
};

struct MetadataIndex {
  std::uint64_t offset = 0;
  std::uint64_t length = 0;
  std::string name;
};

struct Footer {
  std::uint64_t summary_start = 0;  // 0 = there is no summary
  std::uint64_t summary_offset_start = 0;
  std::uint32_t summary_crc = 0;  // 0 = not known
};

/// Position of one message in the uncompressed bytes of its chunk.
struct MessageIndexEntry {
  std::uint64_t log_time = 0;
  std::uint64_t offset = 0;
};

// Each appends one whole record.
void AppendHeader(Bytes& out, const std::string& profile, const std::string& library);
void Append(Bytes& out, const Schema& schema);
void Append(Bytes& out, const Channel& channel);
void Append(Bytes& out, const MessageHeader& header, ByteSpan data);
void Append(Bytes& out, const ChunkHeader& header, ByteSpan compressed);
void AppendMessageIndex(Bytes& out, std::uint16_t channel_id,
                        const std::vector<MessageIndexEntry>& entries);
void Append(Bytes& out, const ChunkIndex& index);
void Append(Bytes& out, const Statistics& statistics);
void Append(Bytes& out, const Metadata& metadata);
void Append(Bytes& out, const MetadataIndex& index);
void AppendSummaryOffset(Bytes& out, Opcode group, std::uint64_t start, std::uint64_t length);
void AppendDataEnd(Bytes& out, std::uint32_t data_crc);
/// Without its CRC, which covers what is before it: AppendFooterCrc completes it.
void AppendFooterBegin(Bytes& out, const Footer& footer);
void AppendFooterCrc(Bytes& out, std::uint32_t crc);

// Each reads a record's content; nothing when it is too short or a length in it is absurd.
std::optional<Schema> ReadSchema(ByteSpan content);
std::optional<Channel> ReadChannel(ByteSpan content);
std::optional<ChunkIndex> ReadChunkIndex(ByteSpan content);
std::optional<Statistics> ReadStatistics(ByteSpan content);
std::optional<Metadata> ReadMetadata(ByteSpan content);
std::optional<MetadataIndex> ReadMetadataIndex(ByteSpan content);
std::optional<Footer> ReadFooter(ByteSpan content);

struct MessageRecord {
  MessageHeader header;
  ByteSpan data;
};
std::optional<MessageRecord> ReadMessage(ByteSpan content);

struct ChunkRecord {
  ChunkHeader header;
  ByteSpan compressed;
};
std::optional<ChunkRecord> ReadChunk(ByteSpan content);

struct Record {
  Opcode opcode;
  ByteSpan content;
};
/// The record at the begin of `bytes`, which is moved on behind it; nothing when it does not end
/// within `bytes`.
std::optional<Record> TakeRecord(ByteSpan& bytes);

/// CRC-32 as of zlib, going on from `crc` (0 at first).
std::uint32_t Crc32(ByteSpan bytes, std::uint32_t crc = 0);

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
