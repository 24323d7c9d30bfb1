#pragma once

#include <concepts>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
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

  template <std::unsigned_integral T>
  void Put(T value) {
    Number(value, sizeof(T));
  }
  void Put(std::string_view text) {
    Put(static_cast<std::uint32_t>(text.size()));
    bytes_.insert(bytes_.end(), text.begin(), text.end());
  }
  /// A map or list of pairs, with the number of its bytes before it.
  template <class Pairs>
  requires requires(const Pairs& pairs) { pairs.begin()->second; }
  void Put(const Pairs& pairs) {
    const std::size_t length_at = BeginLength(4);
    for (const auto& [key, value] : pairs) {
      Put(key);
      Put(value);
    }
    EndLength(length_at, 4);
  }
  void Raw(ByteSpan bytes) { bytes_.insert(bytes_.end(), bytes.begin(), bytes.end()); }

  /// A length of `width` bytes that EndLength fills in with what was appended since.
  std::size_t BeginLength(std::size_t width) {
    const std::size_t at = bytes_.size();
    Number(0, width);
    return at;
  }
  void EndLength(std::size_t at, std::size_t width) {
    std::uint64_t length = bytes_.size() - at - width;
    for (std::size_t i = 0; i < width; ++i, length >>= 8) {
      bytes_[at + i] = static_cast<std::uint8_t>(length);
    }
  }

 private:
  void Number(std::uint64_t value, std::size_t width) {
    for (; width-- > 0; value >>= 8) bytes_.push_back(static_cast<std::uint8_t>(value));
  }

  Bytes& bytes_;
};

/// Reads zeros and nothing beyond the end, and ok() says afterwards whether it came to that.
class ByteReader {
 public:
  explicit ByteReader(ByteSpan bytes) : bytes_(bytes) {}

  template <std::unsigned_integral T>
  void Take(T& number) {
    std::uint64_t value = 0;
    const ByteSpan bytes = Raw(sizeof(T));
    for (std::size_t i = bytes.size(); i-- > 0;) value = value << 8 | bytes[i];
    number = static_cast<T>(value);
  }
  void Take(std::string& text) {
    const ByteSpan bytes = Raw(Take<std::uint32_t>());
    text.assign(bytes.begin(), bytes.end());
  }
  template <class Key, class Value>
  void Take(std::map<Key, Value>& map) {
    ByteReader inner(Raw(Take<std::uint32_t>()));
    while (!inner.at_end()) {
      Key key = inner.Take<Key>();
      map[std::move(key)] = inner.Take<Value>();
    }
    ok_ = ok_ && inner.ok();
  }
  template <class T>
  T Take() {
    T value;
    Take(value);
    return value;
  }
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

  bool at_end() const { return bytes_.empty(); }
  bool ok() const { return ok_; }
  std::size_t left() const { return bytes_.size(); }

 private:
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
inline constexpr std::size_t kFooterSize = 20;  // its content, which ends with the CRC
inline constexpr std::size_t kFooterCrcSize = 4;

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
  static constexpr Opcode kOpcode = Opcode::kSchema;
  std::uint16_t id = 0;
  std::string name;      // "conav_msgs/msg/RobotState"
  std::string encoding;  // "ros2msg"
  std::string text;
};

struct Channel {
  static constexpr Opcode kOpcode = Opcode::kChannel;
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
  static constexpr Opcode kOpcode = Opcode::kChunkIndex;
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
  static constexpr Opcode kOpcode = Opcode::kStatistics;
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
  static constexpr Opcode kOpcode = Opcode::kMetadata;
  std::string name;
  TextMap values;
};

struct MetadataIndex {
  static constexpr Opcode kOpcode = Opcode::kMetadataIndex;
  std::uint64_t offset = 0;
  std::uint64_t length = 0;
  std::string name;
};

struct Footer {
  static constexpr Opcode kOpcode = Opcode::kFooter;
  std::uint64_t summary_start = 0;  // 0 = there is no summary
  std::uint64_t summary_offset_start = 0;
  std::uint32_t summary_crc = 0;  // 0 = not known
};

struct Header {
  static constexpr Opcode kOpcode = Opcode::kHeader;
  std::string profile;
  std::string library;
};

/// Where the messages of one channel are in the uncompressed bytes of their chunk.
struct MessageIndex {
  static constexpr Opcode kOpcode = Opcode::kMessageIndex;
  std::uint16_t channel_id = 0;
  std::vector<std::pair<std::uint64_t, std::uint64_t>> entries;  // log time, offset
};

struct SummaryOffset {
  static constexpr Opcode kOpcode = Opcode::kSummaryOffset;
  std::uint8_t group = 0;  // opcode
  std::uint64_t start = 0;
  std::uint64_t length = 0;
};

struct DataEnd {
  static constexpr Opcode kOpcode = Opcode::kDataEnd;
  std::uint32_t data_crc = 0;
};

/// Appends one whole record: any of the above but those of chunks and messages.
template <class T>
void Append(Bytes& out, const T& record);
void Append(Bytes& out, const MessageHeader& header, ByteSpan data);
void Append(Bytes& out, const ChunkHeader& header, ByteSpan compressed);

/// Reads a record's content (schema, channel, chunk index, statistics, metadata and its index,
/// footer); nothing when it is too short or a length in it is absurd.
template <class T>
std::optional<T> Read(ByteSpan content);

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
