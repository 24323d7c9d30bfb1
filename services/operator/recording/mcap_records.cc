#include "operator/recording/mcap_records.h"

#include <fmt/format.h>
#include <zlib.h>
#include <zstd.h>

namespace conav::bag {
namespace {

/// Writes opcode and, when it ends, the length of what was appended meanwhile.
class RecordScope {
 public:
  RecordScope(Bytes& out, Opcode opcode) : writer_(out) {
    writer_.U8(static_cast<std::uint8_t>(opcode));
    length_at_ = writer_.BeginLength(8);
  }
  ~RecordScope() { writer_.EndLength(length_at_, 8); }
  RecordScope(const RecordScope&) = delete;
  RecordScope& operator=(const RecordScope&) = delete;
  ByteWriter* operator->() { return &writer_; }

 private:
  ByteWriter writer_;
  std::size_t length_at_;
};

void Offsets(ByteWriter& writer, const std::map<std::uint16_t, std::uint64_t>& map) {
  const std::size_t length_at = writer.BeginLength(4);
  for (const auto& [channel, value] : map) {
    writer.U16(channel);
    writer.U64(value);
  }
  writer.EndLength(length_at, 4);
}

std::map<std::uint16_t, std::uint64_t> Offsets(ByteReader& reader) {
  ByteReader inner(reader.Raw(reader.U32()));
  std::map<std::uint16_t, std::uint64_t> map;
  while (!inner.at_end()) {
    const std::uint16_t channel = inner.U16();
    map[channel] = inner.U64();
  }
  return map;
}

template <class T>
std::optional<T> IfWhole(const ByteReader& reader, T value) {
  if (!reader.ok()) return std::nullopt;
  return value;
}

}  // namespace

void AppendHeader(Bytes& out, const std::string& profile, const std::string& library) {
  RecordScope record(out, Opcode::kHeader);
  record->Text(profile);
  record->Text(library);
}

void Append(Bytes& out, const Schema& schema) {
  RecordScope record(out, Opcode::kSchema);
  record->U16(schema.id);
  record->Text(schema.name);
  record->Text(schema.encoding);
  record->Text(schema.text);
}

void Append(Bytes& out, const Channel& channel) {
  RecordScope record(out, Opcode::kChannel);
  record->U16(channel.id);
  record->U16(channel.schema_id);
  record->Text(channel.topic);
  record->Text(channel.message_encoding);
  record->Map(channel.metadata);
}

void Append(Bytes& out, const MessageHeader& header, ByteSpan data) {
  RecordScope record(out, Opcode::kMessage);
  record->U16(header.channel_id);
  record->U32(header.sequence);
  record->U64(header.log_time);
  record->U64(header.publish_time);
  record->Raw(data);
}

void Append(Bytes& out, const ChunkHeader& header, ByteSpan compressed) {
  RecordScope record(out, Opcode::kChunk);
  record->U64(header.start_time);
  record->U64(header.end_time);
  record->U64(header.uncompressed_size);
  record->U32(header.uncompressed_crc);
  record->Text(header.compression);
  record->U64(compressed.size());
  record->Raw(compressed);
}

void AppendMessageIndex(Bytes& out, std::uint16_t channel_id,
                        const std::vector<MessageIndexEntry>& entries) {
  RecordScope record(out, Opcode::kMessageIndex);
  record->U16(channel_id);
  const std::size_t length_at = record->BeginLength(4);
  for (const MessageIndexEntry& entry : entries) {
    record->U64(entry.log_time);
    record->U64(entry.offset);
  }
  record->EndLength(length_at, 4);
}

void Append(Bytes& out, const ChunkIndex& index) {
  RecordScope record(out, Opcode::kChunkIndex);
  record->U64(index.start_time);
  record->U64(index.end_time);
  record->U64(index.offset);
  record->U64(index.length);
  Offsets(*record.operator->(), index.message_index_offsets);
  record->U64(index.message_index_length);
  record->Text(index.compression);
  record->U64(index.compressed_size);
  record->U64(index.uncompressed_size);
}

void Append(Bytes& out, const Statistics& statistics) {
  RecordScope record(out, Opcode::kStatistics);
  record->U64(statistics.message_count);
  record->U16(statistics.schema_count);
  record->U32(statistics.channel_count);
  record->U32(statistics.attachment_count);
  record->U32(statistics.metadata_count);
  record->U32(statistics.chunk_count);
  record->U64(statistics.start_time);
  record->U64(statistics.end_time);
  Offsets(*record.operator->(), statistics.channel_counts);
}

void Append(Bytes& out, const Metadata& metadata) {
  RecordScope record(out, Opcode::kMetadata);
  record->Text(metadata.name);
  record->Map(metadata.values);
}

void Append(Bytes& out, const MetadataIndex& index) {
  RecordScope record(out, Opcode::kMetadataIndex);
  record->U64(index.offset);
  record->U64(index.length);
  record->Text(index.name);
}

void AppendSummaryOffset(Bytes& out, Opcode group, std::uint64_t start, std::uint64_t length) {
  RecordScope record(out, Opcode::kSummaryOffset);
  record->U8(static_cast<std::uint8_t>(group));
  record->U64(start);
  record->U64(length);
}

void AppendDataEnd(Bytes& out, std::uint32_t data_crc) {
  RecordScope record(out, Opcode::kDataEnd);
  record->U32(data_crc);
}

void AppendFooterBegin(Bytes& out, const Footer& footer) {
  ByteWriter writer(out);
  writer.U8(static_cast<std::uint8_t>(Opcode::kFooter));
  writer.U64(kFooterSize);
  writer.U64(footer.summary_start);
  writer.U64(footer.summary_offset_start);
}

void AppendFooterCrc(Bytes& out, std::uint32_t crc) { ByteWriter(out).U32(crc); }

std::optional<Schema> ReadSchema(ByteSpan content) {
  ByteReader reader(content);
  Schema schema;
  schema.id = reader.U16();
  schema.name = reader.Text();
  schema.encoding = reader.Text();
  schema.text = reader.Text();
  return IfWhole(reader, std::move(schema));
}

std::optional<Channel> ReadChannel(ByteSpan content) {
  ByteReader reader(content);
  Channel channel;
  channel.id = reader.U16();
  channel.schema_id = reader.U16();
  channel.topic = reader.Text();
  channel.message_encoding = reader.Text();
  channel.metadata = reader.Map();
  return IfWhole(reader, std::move(channel));
}

std::optional<ChunkIndex> ReadChunkIndex(ByteSpan content) {
  ByteReader reader(content);
  ChunkIndex index;
  index.start_time = reader.U64();
  index.end_time = reader.U64();
  index.offset = reader.U64();
  index.length = reader.U64();
  index.message_index_offsets = Offsets(reader);
  index.message_index_length = reader.U64();
  index.compression = reader.Text();
  index.compressed_size = reader.U64();
  index.uncompressed_size = reader.U64();
  return IfWhole(reader, std::move(index));
}

std::optional<Statistics> ReadStatistics(ByteSpan content) {
  ByteReader reader(content);
  Statistics statistics;
  statistics.message_count = reader.U64();
  statistics.schema_count = reader.U16();
  statistics.channel_count = reader.U32();
  statistics.attachment_count = reader.U32();
  statistics.metadata_count = reader.U32();
  statistics.chunk_count = reader.U32();
  statistics.start_time = reader.U64();
  statistics.end_time = reader.U64();
  statistics.channel_counts = Offsets(reader);
  return IfWhole(reader, std::move(statistics));
}

std::optional<Metadata> ReadMetadata(ByteSpan content) {
  ByteReader reader(content);
  Metadata metadata;
  metadata.name = reader.Text();
  metadata.values = reader.Map();
  return IfWhole(reader, std::move(metadata));
}

std::optional<MetadataIndex> ReadMetadataIndex(ByteSpan content) {
  ByteReader reader(content);
  MetadataIndex index;
  index.offset = reader.U64();
  index.length = reader.U64();
  index.name = reader.Text();
  return IfWhole(reader, std::move(index));
}

std::optional<Footer> ReadFooter(ByteSpan content) {
  ByteReader reader(content);
  Footer footer;
  footer.summary_start = reader.U64();
  footer.summary_offset_start = reader.U64();
  footer.summary_crc = reader.U32();
  return IfWhole(reader, footer);
}

std::optional<MessageRecord> ReadMessage(ByteSpan content) {
  ByteReader reader(content);
  MessageRecord message;
  message.header.channel_id = reader.U16();
  message.header.sequence = reader.U32();
  message.header.log_time = reader.U64();
  message.header.publish_time = reader.U64();
  message.data = reader.Raw(reader.left());
  return IfWhole(reader, message);
}

std::optional<ChunkRecord> ReadChunk(ByteSpan content) {
  ByteReader reader(content);
  ChunkRecord chunk;
  chunk.header.start_time = reader.U64();
  chunk.header.end_time = reader.U64();
  chunk.header.uncompressed_size = reader.U64();
  chunk.header.uncompressed_crc = reader.U32();
  chunk.header.compression = reader.Text();
  chunk.compressed = reader.Raw(reader.U64());
  return IfWhole(reader, std::move(chunk));
}

std::optional<Record> TakeRecord(ByteSpan& bytes) {
  ByteReader reader(bytes);
  const auto opcode = static_cast<Opcode>(reader.U8());
  const std::uint64_t length = reader.U64();
  const ByteSpan content = reader.Raw(length);
  if (!reader.ok()) return std::nullopt;
  bytes = bytes.subspan(kRecordHeaderSize + content.size());
  return Record{opcode, content};
}

std::uint32_t Crc32(ByteSpan bytes, std::uint32_t crc) {
  return static_cast<std::uint32_t>(crc32_z(crc, bytes.data(), bytes.size()));
}

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
